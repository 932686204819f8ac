// The flow-based difference of Gaussians as it was first proposed, in one pass (section 4.5, Figure
// 4.6 a): a stream line is traced, at each of its points a one-dimensional difference of Gaussians is taken
// across it, and a Gaussian along the line adds them up.
// Cost: the steps of the second pass times the samples of the first: about 4 sigma_m times 6 k sigma_e
// bilinear samples.
#import shared/stream
#import shared/pixel_line
#import shared/edge_threshold

struct Params {
    /// -1 / (2 sigma^2) of the narrower Gaussian across the line.
    narrow: f32,
    /// The same of the wider Gaussian.
    wide: f32,
    /// Cut-off across the line, in pixels.
    halfwidth: f32,
    /// Weight of the smoothed lightness.
    base: f32,
    /// Weight of the difference of Gaussians.
    edge: f32,
    /// Standard deviation along the line, pixels.
    sigma: f32,
    /// 0: Euler; 1: second-order Runge-Kutta; 2: two-step; 3: Cabral-Leedom.
    stepping: u32,
    /// How the response becomes an edge image: 0 not at all, 1 binary (4.6), 2 tanh (4.8), 3 smoothstep.
    threshold: u32,
    /// Response from which on there is no line, units of L.
    epsilon: f32,
    /// Steepness of the ramp, per unit of L.
    phi: f32,
    /// Share of the paper that shows through lines, which are narrower than a pixel; 0 where they are not.
    faintness: f32,
}

#params
#input lightness
// (E - G, F), see orientation_field.
#input field
// Lightness less the lines that guides draw.
#input marked
#output target_image r32float

const CABRAL_LEEDOM = 3u;

// Response across the tangent t at p, as (u alpha, alpha).
fn across(p: vec2f, t: vec2f) -> vec2f {
    let upright = abs(t.x) > abs(t.y);
    let slope = select(-t.x / t.y, -t.y / t.x, upright);
    let ds = sqrt(1.0 + slope * slope);
    let main_step = select(vec2f(1.0, slope), vec2f(slope, 1.0), upright);
    let middle = sample_linear(lightness, 0u, p).xy;
    let lines = sample_linear(marked, 2u, p).x - middle.x;
    var narrow = middle;
    var wide = middle;
    for (var k = 1; f32(k) * ds <= params.halfwidth; k++) {
        let d = f32(k) * ds;
        let o = f32(k) * main_step;
        let both = sample_linear(lightness, 0u, p + o).xy + sample_linear(lightness, 0u, p - o).xy;
        narrow += exp(params.narrow * d * d) * both;
        wide += exp(params.wide * d * d) * both;
    }
    let u = dog_of_sums(narrow, wide, params.base, params.edge);
    return vec2f(u * middle.y + lines, middle.y);
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = pixel(id);
    let limit = floor(2.0 * params.sigma + 1e-3);
    let tangent = tensor_tangent(fetch(field, 1u, p));
    var sum = vec2f(0.0);
    if params.stepping != CABRAL_LEEDOM || limit <= 0.0 {
        sum = across(centre(id), tangent);
    }
    // exp(-u^2 / 2 sigma^2) as a power of two; 1 / (sigma sqrt 2).
    let falloff = -0.72134752 / max(params.sigma * params.sigma, 1e-6);
    let inverse = 0.70710678 / max(params.sigma, 1e-3);
    for (var side = -1.0; side <= 1.0; side += 2.0) {
        if params.stepping == CABRAL_LEEDOM {
            var line = pixel_line_begin(p, side * tangent);
            var u = 0.0;
            for (var i = 0; i < pixel_line_steps(limit) && u < limit; i++) {
                let h = pixel_line_aim(&line, field, 1u);
                let end = min(u + h, limit);
                let weight = error_function(end * inverse) - error_function(u * inverse);
                let here = tensor_tangent(fetch(field, 1u, line.pixel));
                sum += weight * across(vec2f(line.pixel) + 0.5, here);
                u = end;
                if !pixel_line_cross(&line, 1u, h) {
                    break;
                }
            }
            continue;
        }
        var line = stream_begin(centre(id), side * tangent, false);
        for (var u = 1.0; u <= limit; u += 1.0) {
            stream_step(&line, field, 1u, 1.0, params.stepping);
            if stream_ends(line, 0u) {
                break;
            }
            sum += exp2(falloff * u * u) * across(line.position, stream_tangent(field, 1u, line.position));
        }
    }
    let edge = edge_of_sum(sum, params.threshold, params.epsilon, params.phi, params.faintness);
    textureStore(target_image, vec2i(id.xy), vec4f(edge));
}
