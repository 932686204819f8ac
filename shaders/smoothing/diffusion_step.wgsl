// One explicit step of tensor-driven diffusion (§ 3.1) towards the eight neighbours.
// Cost: 18 loads and about 60 multiply-adds.
#import grid

struct Params {
    time_step: f32,
}

@group(0) @binding(1) var<uniform> params: Params;
@group(0) @binding(2) var source: texture_2d<f32>;
@group(0) @binding(3) var weights: texture_2d<f32>;
@group(0) @binding(4) var target_image: texture_storage_2d<rgba32float, write>;

// What two pixels on one axis give: their differences to the centre by their coverage and by the mean
// of the weights that both ends have.
fn axis(p: vec2i, o: vec2i, origin: vec3f, own: f32, channel: u32) -> vec3f {
    let a = fetch(source, 0u, p - o);
    let b = fetch(source, 0u, p + o);
    let wa = 0.5 * (own + fetch(weights, 1u, p - o)[channel]) * a.a;
    let wb = 0.5 * (own + fetch(weights, 1u, p + o)[channel]) * b.a;
    return wa * (a.rgb - origin) + wb * (b.rgb - origin);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = pixel(id);
    let origin = fetch(source, 0u, p);
    let own = fetch(weights, 1u, p);
    var sum = axis(p, vec2i(1, 0), origin.rgb, own.x, 0u);
    sum += axis(p, vec2i(0, 1), origin.rgb, own.y, 1u);
    sum += axis(p, vec2i(1, 1), origin.rgb, own.z, 2u);
    sum += axis(p, vec2i(1, -1), origin.rgb, own.w, 3u);
    textureStore(target_image, vec2i(id.xy), vec4f(origin.rgb + params.time_step * sum, origin.a));
}
