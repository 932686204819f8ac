// Second pass of the flow-based bilateral filter (3.10): a bilateral filter along the stream lines of
// a tensor field, sampled at equal distances or where lines cross pixel centres (Listings 3.2, 3.3).
// Cost: per step one bilinear colour sample with one or four exponentials, and one (Euler) or two
// tensor samples with their tangents.
#import shared/coverage
#import shared/stream

struct Params {
    /// Standard deviation along the line, pixels.
    sigma_d: f32,
    /// Standard deviation of the range, in the unit of the colour.
    sigma_r: f32,
    /// Length of a side of the line, whole pixels.
    radius: f32,
    /// How lines are stepped, a number of shared/stream.
    integrator: u32,
    /// Range weights, 0: after the interpolation; 1: before it (3.9); 2: of the nearest pixel.
    sampling: u32,
    /// Samples, 0: at equal distances; 1: where lines cross the centres of rows or columns.
    placement: u32,
}

#params
#input source, tensors
#output target_image rgba32float

const INPUT_TENSORS = 1u;
const SAMPLING_LINEAR = 0u;
const SAMPLING_NEAREST = 2u;
const PLACEMENT_CENTRES = 1u;

// A pixel times its range weight, its coverage and its share.
fn pixel_weighted(p: vec2i, origin: vec3f, domain: f32, range: f32, share: f32) -> vec4f {
    let v = fetch(source, 0u, p);
    let d = v.rgb - origin;
    return share * v.a * exp2(range * dot(d, d) + domain) * vec4f(v.rgb, 1.0);
}

// The sample at p times its domain and range weights and its coverage.
fn weighted(p: vec2f, origin: vec3f, domain: f32, range: f32) -> vec4f {
    if params.sampling == SAMPLING_LINEAR {
        let tap = sample_covered(source, 0u, p);
        let d = tap.rgb / max(tap.a, LEAST_COVERAGE) - origin;
        return exp2(range * dot(d, d) + domain) * tap;
    }
    if params.sampling == SAMPLING_NEAREST {
        return pixel_weighted(vec2i(floor(p)), origin, domain, range, 1.0);
    }
    let q = p - 0.5;
    let corner = floor(q);
    let f = q - corner;
    let i = vec2i(corner);
    return pixel_weighted(i, origin, domain, range, (1.0 - f.x) * (1.0 - f.y))
        + pixel_weighted(i + vec2i(1, 0), origin, domain, range, f.x * (1.0 - f.y))
        + pixel_weighted(i + vec2i(0, 1), origin, domain, range, (1.0 - f.x) * f.y)
        + pixel_weighted(i + vec2i(1, 1), origin, domain, range, f.x * f.y);
}

// How far back from p along t the line last crossed the centre of a row or column (3.11).
fn distance_back(p: vec2f, t: vec2f) -> f32 {
    let f = fract(p + 0.5);
    // A crossing within rounding of p is at p.
    if any(min(f, 1.0 - f) < vec2f(1e-4)) {
        return 0.0;
    }
    let far = vec2f(1e3);
    let ahead = select(f, f - 1.0, t < vec2f(0.0));
    let back = select(ahead / t, far, abs(t) < vec2f(1e-6));
    return min(back.x, back.y);
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    covered_begin(source);
    let start = centre(id);
    let tangent = tensor_tangent(fetch(tensors, INPUT_TENSORS, pixel(id)));
    let origin = fetch(source, 0u, pixel(id));
    // Both Gaussians as powers of two.
    let domain = -0.72134752 / max(params.sigma_d * params.sigma_d, 1e-6);
    let range = -0.72134752 / max(params.sigma_r * params.sigma_r, 1e-6);
    let centres = params.placement == PLACEMENT_CENTRES;

    let first = vec4f(origin.rgb * origin.a, origin.a);
    var sum = select(first, vec4f(0.0), centres);
    for (var side = -1.0; side <= 1.0; side += 2.0) {
        var line = stream_begin(start, side * tangent, false);
        var last = first;
        var last_u = 0.0;
        for (var u = 1.0; u <= params.radius; u += 1.0) {
            stream_step(&line, tensors, INPUT_TENSORS, 1.0, params.integrator);
            var back = 0.0;
            if centres {
                back = distance_back(line.position, line.direction);
                if back >= 1.0 {
                    continue;
                }
            }
            let p = line.position - back * line.direction;
            if stream_outside(0u, p) {
                break;
            }
            let at = u - back;
            let value = weighted(p, origin.rgb, domain * at * at, range);
            if centres {
                // The trapezoidal rule (3.12).
                sum += (0.5 * (at - last_u)) * (last + value);
                last = value;
                last_u = at;
            } else {
                sum += value;
            }
        }
    }
    // No sample on either side leaves the pixel as it is.
    let color = select(origin.rgb, sum.rgb / sum.a, sum.a > LEAST_COVERAGE);
    textureStore(target_image, vec2i(id.xy), vec4f(color, origin.a));
}
