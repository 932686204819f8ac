// Line integral convolution of a colour with a Gaussian (2.186) along the stream lines of a tensor
// field, with the length adapted to the anisotropy (§ 6.3.1) or to the curvature (§ 6.3.2).
// Cost: per step one bilinear colour sample and one (Euler, two-step) or two tensor samples with their
// tangents.
#import shared/coverage
#import shared/stream

struct Params {
    /// Standard deviation along the line, pixels.
    sigma: f32,
    /// Step size h, pixels.
    step: f32,
    /// Most by which steps may be stretched, at least 1.
    stretch: f32,
    /// A side ends at a step that turns by more than the angle of this cosine.
    least_turn: f32,
    /// 0: Euler; 1: second-order Runge-Kutta; 2: two-step.
    integrator: u32,
    /// 0: none; 1: anisotropy; 2: angle.
    adapt: u32,
    /// 1: tensors of the nearest pixels; 0: interpolated.
    nearest: u32,
}

#params
#input source, tensors
// (E - G, F), see orientation_field.
#input field
#output target_image rgba32float

const INPUT_TENSORS = 1u;
const INPUT_FIELD = 2u;

// Weighted colours, multiplied by their coverage, and the sum of the weights.
struct Sum {
    colour: vec4f,
    norm: f32,
}

// Pixels of a side of the line. A last bit must not decide whether a whole number of them is reached.
fn longest(sigma: f32) -> f32 {
    return floor(2.0 * sigma + 1e-3) + 1e-3;
}

// The Gaussian along both sides of the line through `origin`, added to `first`.
fn gather(origin: vec2f, tangent: vec2f, sigma: f32, first: Sum, inside: bool) -> Sum {
    let limit = longest(sigma);
    let radius = floor(2.0 * sigma + 1e-3);
    // exp(-u^2 / 2 sigma^2) as a power of two.
    let falloff = -0.72134752 / max(sigma * sigma, 1e-6);

    let steps = floor(limit / params.step);
    let stretch = stream_stretched(steps, stream_few_steps(steps, params.stretch));
    let step = stretch * params.step;
    // The cosine of so many times the angle whose cosine is c, exact for one and two times; no more than c,
    // since -1 stands for any turn.
    let c = params.least_turn;
    let least_turn = min(c, 1.0 - stretch * ((1.0 - c) * (1.0 - c) + stretch * c * (1.0 - c)));

    // Loops take no parameter from memory that they can hold.
    let integrator = params.integrator;
    let by_angle = params.adapt == 2u;
    var sum = first;
    for (var side = -1.0; side <= 1.0; side += 2.0) {
        var line = stream_begin(origin, side * tangent, inside);
        line.nearest = params.nearest != 0u;
        var u = 0.0;
        while u + step <= limit {
            stream_step(&line, field, INPUT_FIELD, step, integrator);
            var du = step;
            if by_angle {
                du = max(du, acos(min(line.turn, 1.0)) * radius / 3.14159265);
            }
            u += du;
            if u > limit || line.turn < least_turn || stream_ends(line, 0u) {
                break;
            }
            let weight = exp2(falloff * u * u);
            sum.colour += weight * sample_covered_among(source, stream_surroundings(line, 0u, line.position));
            sum.norm += weight;
        }
    }
    return sum;
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    covered_begin(source);
    let origin = centre(id);
    let tensor = fetch(tensors, INPUT_TENSORS, pixel(id));
    var sigma = params.sigma;
    if params.adapt == 1u {
        let a = 1.0 + tensor_anisotropy(tensor);
        sigma *= 0.25 * a * a;
    }
    let limit = longest(sigma);
    let tangent = tensor_tangent(tensor);
    let first = Sum(fetch_covered(source, 0u, pixel(id)), 1.0);
    var total: Sum;
    if stream_inside(0u, origin, limit) && stream_inside(INPUT_FIELD, origin, limit) {
        total = gather(origin, tangent, sigma, first, true);
    } else {
        total = gather(origin, tangent, sigma, first, false);
    }
    textureStore(target_image, vec2i(id.xy), vec4f(unpremultiply(total.colour).rgb, full_or(total.colour.a / total.norm)));
}
