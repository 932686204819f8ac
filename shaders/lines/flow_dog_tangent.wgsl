// Second pass of the separable flow-based difference of Gaussians: a Gaussian of the response along
// the stream line of the tensor field, then the threshold (section 4.5, 4.8).
// Cost: per step one bilinear sample of the response and one (Euler, two-step) or two tensor
// samples.
#import shared/stream
#import shared/coverage
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
    /// Share of the paper that shows through lines, which are narrower than a pixel; 0 where they are not.
    faintness: f32,
}

#params
#input response
// (E - G, F), see orientation_field.
#input field
#output target_image r32float

// The Gaussian along both sides of the line through `origin`, up to `limit` pixels away, added to `first`.
fn gather(origin: vec2f, tangent: vec2f, limit: f32, first: vec2f, inside: bool) -> vec2f {
    // exp(-u^2 / 2 sigma^2) as a power of two.
    let falloff = -0.72134752 / max(params.sigma * params.sigma, 1e-6);
    // Loops take no parameter from memory that they can hold.
    let integrator = params.integrator;
    var sum = first;
    for (var side = -1.0; side <= 1.0; side += 2.0) {
        var line = stream_begin(origin, side * tangent, inside);
        for (var u = 1.0; u <= limit; u += 1.0) {
            stream_step(&line, field, 1u, 1.0, integrator);
            if stream_ends(line, 0u) {
                break;
            }
            let around = stream_surroundings(line, 0u, line.position);
            sum += exp2(falloff * u * u) * sample_multiplied_among(response, around).xy;
        }
    }
    return sum;
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    covered_begin(response);
    let origin = centre(id);
    // A last bit must not decide whether a whole number of pixels is reached.
    let limit = floor(2.0 * params.sigma + 1e-3);
    let tangent = tensor_tangent(fetch(field, 1u, pixel(id)));
    let first = fetch(response, 0u, pixel(id)).xy;
    var sum: vec2f;
    if stream_inside(0u, origin, limit) && stream_inside(1u, origin, limit) {
        sum = gather(origin, tangent, limit, first, true);
    } else {
        sum = gather(origin, tangent, limit, first, false);
    }
    let edge = edge_of_sum(sum, params.threshold, params.epsilon, params.phi, params.faintness);
    textureStore(target_image, vec2i(id.xy), vec4f(edge));
}
