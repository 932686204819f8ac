// One level of a pyramid of maxima up. Cost: 4 loads.
#import gpu/grid

struct Params {
    /// The channel to look at.
    channel: u32,
}

#params
#input source
#output target_image r32float

fn value(p: vec2i) -> f32 {
    return fetch(source, 0u, p)[params.channel];
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    // At odd sizes the clamped children change nothing.
    let p = 2 * pixel(id);
    let upper = max(value(p), value(p + vec2i(1, 0)));
    let lower = max(value(p + vec2i(0, 1)), value(p + vec2i(1, 1)));
    textureStore(target_image, vec2i(id.xy), vec4f(max(upper, lower)));
}
