// One pass of the orientation-aligned bilateral filter (Listing 3.1), along the gradient or along the
// tangent; the range is measured as Euclidean distance of the three colour channels.
// Cost: about 2 cutoff taps of two loads, one interpolation and one or two exponentials.
#import gpu/line
#import shared/coverage
#import shared/tensor

struct Params {
    /// Standard deviation along the line, pixels.
    sigma_d: f32,
    /// Standard deviation of the range, in the unit of the colour.
    sigma_r: f32,
    /// Distance of the last tap, pixels.
    cutoff: f32,
    /// Growth of the tangent's scale, and shrinking of the gradient's, per unit of anisotropy.
    elongation: f32,
    /// 1: along the tangent; 0: along the gradient.
    tangential: u32,
    /// Range weights, 0: after the interpolation; 1: before it (3.9); 2: of the nearest pixel.
    sampling: u32,
    /// 1: the fourth channel of the tensors is a factor on `sigma_r`.
    scaled: u32,
}

#params
#input source, tensors
#output target_image rgba32float

const SAMPLING_LINEAR = 0u;
const SAMPLING_NEAREST = 2u;

// What weighs a tap: the colour of the pixel itself, and both Gaussians as powers of two.
struct Weighting {
    origin: vec3f,
    domain: f32,
    range: f32,
    // `params.sampling`: loops take no parameter from memory that they can hold.
    sampling: u32,
}

// Of a colour, for the `domain` part of the exponent.
fn weight(color: vec3f, w: Weighting, domain: f32) -> f32 {
    let d = color - w.origin;
    return exp2(w.range * dot(d, d) + domain);
}

// The tap `k` steps along the line times its weight.
fn weighted(line: Line, k: i32, w: Weighting, inside: bool) -> vec4f {
    let domain = w.domain * f32(k) * f32(k);
    if w.sampling == SAMPLING_LINEAR {
        let at = line_place(line, k);
        let p = line.pixel + at.offset;
        let mixed = covered_between(source, 0u, p, line.texel + at.offset, at.next, at.f, inside);
        let color = mixed.rgb / max(mixed.a, LEAST_COVERAGE);
        return weight(color, w, domain) * mixed;
    }
    let tap = line_tap(source, 0u, line, k, inside);
    let near = w.sampling == SAMPLING_NEAREST;
    let shares = vec2f(1.0 - tap.f, tap.f);
    let share = select(shares, vec2f(shares >= vec2f(0.5)), near);
    let wa = share.x * tap.a.a * weight(tap.a.rgb, w, domain);
    let wb = share.y * tap.b.a * weight(tap.b.rgb, w, domain);
    return wa * vec4f(tap.a.rgb, 1.0) + wb * vec4f(tap.b.rgb, 1.0);
}

// The taps of both sides, added to `first`.
fn gather(line: Line, steps: i32, w: Weighting, first: vec4f, inside: bool) -> vec4f {
    var sum = first;
    for (var k = 1; k <= steps; k++) {
        sum += weighted(line, -k, w, inside);
        sum += weighted(line, k, w, inside);
    }
    return sum;
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    covered_begin(source);
    let p = pixel(id);
    let tensor = fetch(tensors, 1u, p);
    let tangent = tensor_tangent(tensor);
    let stretch = 1.0 + params.elongation * tensor_anisotropy(tensor);
    let t = select(vec2f(tangent.y, -tangent.x), tangent, params.tangential != 0u);
    let scale = select(1.0 / stretch, stretch, params.tangential != 0u);

    // Steps of one pixel along the axis nearer to t: taps then lie between two pixels (3.6, 3.7).
    let along_x = abs(t.x) > abs(t.y);
    let major = select(t.y, t.x, along_x);
    let line = line_through(p, 0u, along_x, select(t.x, t.y, along_x) / major);
    let steps = i32((params.cutoff * scale + 1e-3) * abs(major));

    let sigma_d = params.sigma_d * scale * abs(major);
    let sigma_r = params.sigma_r * select(1.0, tensor.w, params.scaled != 0u);
    let origin = fetch(source, 0u, p);
    let w = Weighting(
        origin.rgb,
        -0.72134752 / max(sigma_d * sigma_d, 1e-6),
        -0.72134752 / max(sigma_r * sigma_r, 1e-6),
        params.sampling,
    );
    let first = premultiply(origin);
    var sum: vec4f;
    if line_inside(line, 0u, steps) {
        sum = gather(line, steps, w, first, true);
    } else {
        sum = gather(line, steps, w, first, false);
    }
    let color = select(origin.rgb, sum.rgb / sum.a, sum.a > LEAST_COVERAGE);
    textureStore(target_image, vec2i(id.xy), vec4f(color, origin.a));
}
