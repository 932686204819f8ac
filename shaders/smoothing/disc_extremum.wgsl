// The greatest or least value of each channel within a disc: dilation or erosion (§ 5.1).
// Cost: one load and one comparison per pixel of the disc, about 3.1 (radius + 1/2)^2.
#import grid

struct Params {
    // Rows on each side of the centre.
    extent: i32,
    // Pixels of the disc lie at most the square root of this away.
    limit: i32,
    // 1: greatest; -1: least.
    sign: f32,
}

@group(0) @binding(1) var<uniform> params: Params;
@group(0) @binding(2) var source: texture_2d<f32>;
@group(0) @binding(3) var target_image: texture_storage_2d<rgba32float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = pixel(id);
    let origin = fetch(source, 0u, p);
    var best = vec3f(0.0);
    var seen = false;
    for (var dy = -params.extent; dy <= params.extent; dy++) {
        for (var dx = -params.extent; dx <= params.extent; dx++) {
            let tap = fetch(source, 0u, p + vec2i(dx, dy));
            if dx * dx + dy * dy > params.limit || tap.a < 0.5 {
                continue;
            }
            let value = params.sign * tap.rgb;
            best = select(value, max(best, value), seen);
            seen = true;
        }
    }
    let color = select(origin.rgb, params.sign * best, seen);
    textureStore(target_image, vec2i(id.xy), vec4f(color, origin.a));
}
