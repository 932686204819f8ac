// One explicit step of tensor-driven diffusion (§ 3.1) towards the eight neighbours.
// Cost: 5 loads, 18 reads of workgroup memory and about 60 multiply-adds.
#import gpu/group

struct Params {
    /// Time step, up to 1/4.
    time_step: f32,
}

#params
#input source, weights
#output target_image rgba32float

// The workgroup's pixels and those around them.
var<workgroup> colours: array<vec4f, 100>;
var<workgroup> shares: array<vec4f, 100>;

fn share_pixels(id: vec3u) {
    let local = group_local(id);
    let size = group_size(id) + 2;
    for (var y = local.y; y < size.y; y += 8) {
        for (var x = local.x; x < size.x; x += 8) {
            let p = group_corner(id) + vec2i(x, y) - 1;
            colours[y * 10 + x] = fetch(source, 0u, p);
            shares[y * 10 + x] = fetch(weights, 1u, p);
        }
    }
    workgroupBarrier();
}

struct Tap {
    colour: vec4f,
    weights: vec4f,
}

fn tap(id: vec3u, offset: vec2i) -> Tap {
    if shared_windows {
        let place = group_seat(id) + offset + 1;
        return Tap(colours[place.y * 10 + place.x], shares[place.y * 10 + place.x]);
    }
    let p = group_pixel(id) + offset;
    return Tap(fetch(source, 0u, p), fetch(weights, 1u, p));
}

// What two pixels on one axis give: their differences to the centre by their coverage and by the mean
// of the weights that both ends have.
fn axis(id: vec3u, o: vec2i, origin: vec3f, own: f32, channel: u32) -> vec3f {
    let a = tap(id, -o);
    let b = tap(id, o);
    let wa = 0.5 * (own + a.weights[channel]) * a.colour.a;
    let wb = 0.5 * (own + b.weights[channel]) * b.colour.a;
    return wa * (a.colour.rgb - origin) + wb * (b.colour.rgb - origin);
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    if shared_windows {
        share_pixels(id);
    }
    let centre = tap(id, vec2i(0));
    let origin = centre.colour;
    let own = centre.weights;
    var sum = axis(id, vec2i(1, 0), origin.rgb, own.x, 0u);
    sum += axis(id, vec2i(0, 1), origin.rgb, own.y, 1u);
    sum += axis(id, vec2i(1, 1), origin.rgb, own.z, 2u);
    sum += axis(id, vec2i(1, -1), origin.rgb, own.w, 3u);
    if !outside(id) {
        textureStore(target_image, vec2i(id.xy), vec4f(origin.rgb + params.time_step * sum, origin.a));
    }
}
