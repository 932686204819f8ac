// Blend of two pictures, by coverage.
// Cost: two loads and eight multiply-adds.
#import shared/coverage

struct Params {
    /// Share of the second picture, 0..=1.
    amount: f32,
}

@group(0) @binding(1) var<uniform> params: Params;
@group(0) @binding(2) var first: texture_2d<f32>;
@group(0) @binding(3) var second: texture_2d<f32>;
@group(0) @binding(4) var target_image: texture_storage_2d<rgba32float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let a = fetch(first, 0u, pixel(id));
    let b = fetch(second, 1u, pixel(id));
    let weights = vec2f((1.0 - params.amount) * a.a, params.amount * b.a);
    let mixed = vec4f(weights.x * a.rgb + weights.y * b.rgb, weights.x + weights.y);
    textureStore(target_image, vec2i(id.xy), unpremultiply(mixed));
}
