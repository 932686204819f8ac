// Gradient of the L of a Lab image by the Sobel operator (2.23) in the first two channels; what is longer than `longest`
// is shortened to the inverse of its length.
// Cost: nine loads.
#import gpu/grid

struct Params {
    /// Longest gradient that counts in full, units of L per pixel.
    longest: f32,
}

@group(0) @binding(1) var<uniform> params: Params;
@group(0) @binding(2) var source: texture_2d<f32>;
@group(0) @binding(3) var target_image: texture_storage_2d<rgba32float, write>;

// By how much a neighbour exceeds the centre; where it is transparent it stands for the centre.
fn excess(p: vec2i, centre: f32) -> f32 {
    let v = fetch(source, 0u, p);
    return (v.x - centre) * v.w;
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = pixel(id);
    let v = fetch(source, 0u, p);
    let left_up = excess(p + vec2i(-1, -1), v.x);
    let left_down = excess(p + vec2i(-1, 1), v.x);
    let right_up = excess(p + vec2i(1, -1), v.x);
    let right_down = excess(p + vec2i(1, 1), v.x);
    let x = 0.25 * (excess(p + vec2i(1, 0), v.x) - excess(p - vec2i(1, 0), v.x))
        + 0.125 * ((right_up - left_up) + (right_down - left_down));
    let y = 0.25 * (excess(p + vec2i(0, 1), v.x) - excess(p - vec2i(0, 1), v.x))
        + 0.125 * ((left_down - left_up) + (right_down - right_up));
    let share = min(params.longest / max(sqrt(x * x + y * y), 1e-6), 1.0);
    let shorter = v.w * share * share;
    textureStore(target_image, vec2i(id.xy), vec4f(x * shorter, y * shorter, 0.0, 1.0));
}
