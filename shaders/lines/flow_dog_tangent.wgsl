// Second pass of the separable flow-based difference of Gaussians: a Gaussian of the response along
// the stream line of the tensor field, then the threshold (section 4.5, 4.8).
// Cost: per step one bilinear sample of the response and one (Euler, two-step) or two tensor
// samples.
#import shared/stream
#import shared/edge_threshold

struct Params {
    /// Standard deviation along the line, pixels.
    sigma: f32,
    /// 0: Euler; 1: second-order Runge-Kutta; 2: two-step.
    integrator: u32,
    /// How the response becomes an edge image: 0 not at all, 1 binary (4.6), 2 tanh (4.8), 3 smoothstep,
    /// 4 not at all but for what is not covered.
    threshold: u32,
    /// Response from which on there is no line, units of L.
    epsilon: f32,
    /// Steepness of the ramp, per unit of L.
    phi: f32,
}

@group(0) @binding(1) var<uniform> params: Params;
@group(0) @binding(2) var response: texture_2d<f32>;
// (E - G, F), see orientation_field.
@group(0) @binding(3) var field: texture_2d<f32>;
@group(0) @binding(4) var target_image: texture_storage_2d<r32float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let origin = centre(id);
    // A last bit must not decide whether a whole number of pixels is reached.
    let limit = floor(2.0 * params.sigma + 1e-3);
    // exp(-u^2 / 2 sigma^2) as a power of two.
    let falloff = -0.72134752 / max(params.sigma * params.sigma, 1e-6);
    let tangent = tensor_tangent(fetch(field, 1u, pixel(id)));
    var sum = fetch(response, 0u, pixel(id)).xy;
    for (var side = -1.0; side <= 1.0; side += 2.0) {
        var line = stream_begin(origin, side * tangent);
        for (var u = 1.0; u <= limit; u += 1.0) {
            stream_step(&line, field, 1u, 1.0, params.integrator);
            if stream_outside(0u, line.position) {
                break;
            }
            sum += exp2(falloff * u * u) * sample_linear(response, 0u, line.position).xy;
        }
    }
    let edge = edge_of_sum(sum, params.threshold, params.epsilon, params.phi);
    textureStore(target_image, vec2i(id.xy), vec4f(edge));
}
