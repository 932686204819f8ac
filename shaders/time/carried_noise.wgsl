// Noise that is carried along motion: that of the screen where each of two layers was anchored, faded into one another.
// Cost: 65 loads and about 200 operations.
#import shared/motion

struct Params {
    /// Share of the second layer, 0..=1.
    share: f32,
    /// -1 / (4 sigma^2), sigma the standard deviation of the smoothing of the noise in pixels: how fast it forgets itself.
    falloff: f32,
    /// 1 / distance in pixels of the two places from which on layers show noise of their own.
    decay: f32,
}

#params
#input of_both, first, second, chain
#output target_image rgba32float

// The noise at a place; beyond the border it is mirrored.
fn noise_at(image: texture_2d<f32>, slot: u32, p: vec2f) -> f32 {
    let full = vec2f(grid.inputs[0].zw);
    return sample_sharp_covered(image, slot, full - abs(full - abs(p))).x - 0.5;
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let ways = fetch(chain, 3u, pixel(id));
    let p = centre(id) + ways.xy;
    let q = centre(id) + ways.zw;
    let between = ways.zw - ways.xy;
    let apart = dot(between, between);
    let t = min(sqrt(apart) * params.decay, 1.0);
    let shared_part = 1.0 - t * t * (3.0 - 2.0 * t);
    let own_part = sqrt(max(1.0 - shared_part * shared_part, 0.0));
    let at_first = shared_part * noise_at(of_both, 0u, p) + own_part * noise_at(first, 1u, p);
    let at_second = shared_part * noise_at(of_both, 0u, q) + own_part * noise_at(second, 2u, q);
    // The common noise is like itself at both places as far as these are near: the variance of the sum is known.
    let alike = shared_part * shared_part * exp(max(params.falloff * apart, -80.0));
    let b = params.share;
    let a = 1.0 - b;
    let variance = a * a + b * b + 2.0 * a * b * alike;
    let value = clamp(0.5 + (at_first * a + at_second * b) / sqrt(variance), 0.0, 1.0);
    textureStore(target_image, vec2i(id.xy), vec4f(vec3f(value), 1.0));
}
