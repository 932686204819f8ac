// One level of a colour pyramid up, by Lanczos resampling of three lobes (thesis § 5.5.1).
//
// Where asked for, values stay within those under the main lobe: the side lobes draw dark rings around highlights.
// Where coverage is partial their negative weights could outweigh the rest, and the mean of the four
// pixels below takes over.
//
// Cost: 11 loads, 144 reads of workgroup memory and 600 operations per pixel of the coarser level.
#import gpu/group

struct Params {
    /// Weights at distances 1/2, 3/2, 5/2, 7/2 pixels.
    near: vec4f,
    /// Weights at distances 9/2, 11/2 pixels.
    far: vec4f,
    /// 1: values stay within those under the main lobe.
    limited: u32,
}

#params
#input source
#output target_image rgba32float

fn lobe(d: i32) -> f32 {
    // Offsets 0, 1, 2, ... and -1, -2, -3, ... lie 1/2, 3/2, 5/2, ... from the centre.
    let i = select(-1 - d, d, d >= 0);
    return select(params.far[max(i - 4, 0)], params.near[min(i, 3)], i < 4);
}

// The pixels under the kernels of a workgroup.
var<workgroup> square: array<vec4f, 676>;

// The pixel at an offset from the first one right of and below the centre.
fn tap(id: vec3u, offset: vec2i) -> vec4f {
    if shared_windows {
        let place = 2 * group_seat(id) + offset + 6;
        return square[place.y * 26 + place.x];
    }
    return fetch(source, 0u, 2 * group_pixel(id) + 1 + offset);
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    if shared_windows {
        let local = group_local(id);
        let size = 2 * group_size(id) + 10;
        for (var y = local.y; y < size.y; y += 8) {
            for (var x = local.x; x < size.x; x += 8) {
                square[y * 26 + x] = fetch(source, 0u, 2 * group_corner(id) - 5 + vec2i(x, y));
            }
        }
        workgroupBarrier();
    }
    var sharp = vec4f(0.0);
    var least = vec3f(3e38);
    var most = vec3f(-3e38);
    var mean = vec4f(0.0);
    for (var j = -6; j < 6; j++) {
        var row = vec4f(0.0);
        for (var i = -6; i < 6; i++) {
            let c = tap(id, vec2i(i, j));
            let covered = vec4f(c.rgb * c.a, c.a);
            row += lobe(i) * covered;
            if i >= -2 && i < 2 && j >= -2 && j < 2 && c.a > 0.0 {
                least = min(least, c.rgb);
                most = max(most, c.rgb);
            }
            if i >= -1 && i < 1 && j >= -1 && j < 1 {
                mean += 0.25 * covered;
            }
        }
        sharp += lobe(j) * row;
    }
    let below = mean.rgb / max(mean.a, 1e-6);
    var resampled = sharp.rgb / max(sharp.a, 0.25);
    if params.limited != 0u {
        resampled = min(max(resampled, least), most);
    }
    let share = clamp(4.0 * min(sharp.a, mean.a) - 3.0, 0.0, 1.0);
    if !outside(id) {
        textureStore(target_image, vec2i(id.xy), vec4f(mix(below, resampled, share), mean.a));
    }
}
