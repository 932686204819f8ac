// Soft quantization of the lightness of a Lab image (section 4.6): bins continue below 0 and above 100.
// Cost: one to nine loads, a tanh and two square roots.
#import shared/sampling

struct Params {
    /// Width of a bin, units of L.
    width: f32,
    /// 1 / width.
    inverse_width: f32,
    /// Steepness at the middle of a bin, where the output steps, per unit of L; used when not adaptive.
    phi: f32,
    /// Nonzero: steepness from the gradient of L, cut to lambda_delta..omega_delta.
    adaptive: u32,
    /// Gradient, in L per pixel, that has steepness `lambda_phi`.
    lambda_delta: f32,
    /// 1 / (omega_delta - lambda_delta).
    inverse_delta: f32,
    /// Least steepness, per unit of L.
    lambda_phi: f32,
    /// Greatest steepness, per unit of L.
    omega_phi: f32,
    /// 1 / gradient of the surroundings, in L per pixel, from which on there are steps; 0: everywhere.
    inverse_least: f32,
    /// Narrowest border of two levels, pixels; used where steps are bounded by gradients.
    crispest: f32,
}

#params
#input source
// The mean gradient of L around each pixel, at half the size.
#input tones_around
#output target_image rgba32float

const INPUT_SOURCE: u32 = 0u;
const INPUT_TONES_AROUND: u32 = 1u;

// Lightness of a neighbour; where it is not covered, that of the pixel itself.
fn neighbour(p: vec2i, own: f32) -> f32 {
    let v = fetch(source, INPUT_SOURCE, p);
    return own + (v.x - own) * clamp(v.w, 0.0, 1.0);
}

fn of_pixel(id: vec3u) -> vec4f {
    let p = pixel(id);
    let v = fetch(source, INPUT_SOURCE, p);
    var phi = params.phi;
    var stepped = 1.0;
    if params.adaptive != 0u || params.inverse_least > 0.0 {
        let gx = 0.5 * (neighbour(p + vec2i(1, 0), v.x) - neighbour(p - vec2i(1, 0), v.x));
        let gy = 0.5 * (neighbour(p + vec2i(0, 1), v.x) - neighbour(p - vec2i(0, 1), v.x));
        let g = sqrt(gx * gx + gy * gy);
        if params.adaptive != 0u {
            let t = clamp((g - params.lambda_delta) * params.inverse_delta, 0.0, 1.0);
            phi = params.lambda_phi + t * (params.omega_phi - params.lambda_phi);
        }
        if params.inverse_least > 0.0 {
            phi = min(phi, 2.0 / max(params.crispest * g, 1e-6));
            let around = sample_linear(tones_around, INPUT_TONES_AROUND, 0.5 * centre(id)).xy;
            let t = clamp((sqrt(dot(around, around)) * params.inverse_least - 0.6) * 1.25, 0.0, 1.0);
            stepped = t * t * (3.0 - 2.0 * t);
        }
    }
    let middle = (floor(v.x * params.inverse_width) + 0.5) * params.width;
    let x = clamp(phi * (v.x - middle), -20.0, 20.0);
    let level = middle + 0.5 * params.width * tanh(x);
    let lightness = v.x + stepped * (level - v.x);
    return vec4f(lightness, v.yzw);
}
