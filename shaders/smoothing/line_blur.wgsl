// Smooths noise along straight lines of one direction, which makes hatching of it, and stretches its contrast about
// middle grey.
// Cost: a bilinear sample per step.
#import shared/sampling

struct Params {
    /// From sample to sample, pixels.
    step: vec2f,
    /// Samples on each side.
    count: i32,
    /// -1 / (2 sigma^2), sigma in steps.
    falloff: f32,
    /// Factor on the contrast.
    gain: f32,
}

#params
#input source
#output target_image rgba32float

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    var sum = 0.0;
    var weights = 0.0;
    for (var k = -params.count; k <= params.count; k++) {
        let weight = exp(params.falloff * f32(k * k));
        sum += weight * sample_linear(source, 0u, centre(id) + f32(k) * params.step).x;
        weights += weight;
    }
    let value = clamp(0.5 + params.gain * (sum / weights - 0.5), 0.0, 1.0);
    textureStore(target_image, vec2i(id.xy), vec4f(vec3f(value), 1.0));
}
