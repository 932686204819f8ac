// First pass of the separable flow-based difference of Gaussians (Listing 4.1): a one-dimensional
// difference of Gaussians across the tangent, on lightness and coverage (L alpha, alpha).
//
// Steps have length 1 along the axis nearer to the gradient, so a sample lies between two pixels of
// one row or column, and two loads interpolate it exactly as a bilinear sample would.
// Cost: 4 loads and two exponentials per step, about 3 k sigma_e steps.
#import gpu/line
#import shared/coverage
#import shared/tensor
#import shared/edge_threshold

struct Params {
    /// -1 / (2 sigma^2) of the narrower Gaussian.
    narrow: f32,
    /// The same of the wider Gaussian.
    wide: f32,
    /// Cut-off, in pixels.
    halfwidth: f32,
    /// Weight of the smoothed lightness.
    base: f32,
    /// Weight of the difference of Gaussians.
    edge: f32,
    /// 1: the fourth channel of the field is a factor on both standard deviations and the cut-off.
    scaled: u32,
}

#params
#input lightness
// (E - G, F), see orientation_field, or with a factor, see control_field.
#input field
#output target_image rg32float

// Longest reach, pixels.
const MOST_REACH: f32 = 1024.0;

// The interpolated sample k steps along the line.
fn sample(line: Line, k: i32, inside: bool) -> vec2f {
    let place = line_place(line, k);
    let p = line.pixel + place.offset;
    let texel = line.texel + place.offset;
    return multiplied_between(lightness, 0u, p, texel, place.next, place.f, inside).xy;
}

struct Sums {
    narrow: vec2f,
    wide: vec2f,
}

// Both Gaussians along the line, of which the pixel itself holds `middle`, `factor` times as wide.
fn gather(line: Line, middle: vec2f, factor: f32, inside: bool) -> Sums {
    let ds = sqrt(1.0 + line.slope * line.slope);
    // Loops take no parameter from memory that they can hold.
    let rates = vec2f(params.narrow, params.wide) / (factor * factor);
    let halfwidth = min(params.halfwidth * factor, MOST_REACH);
    var sums = Sums(middle, middle);
    for (var k = 1; f32(k) * ds <= halfwidth; k++) {
        let d = f32(k) * ds;
        let both = sample(line, k, inside) + sample(line, -k, inside);
        sums.narrow += exp(rates.x * d * d) * both;
        sums.wide += exp(rates.y * d * d) * both;
    }
    return sums;
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    covered_begin(lightness);
    let p = pixel(id);
    let orientation = fetch(field, 1u, p);
    let t = tensor_tangent(orientation);
    let factor = select(1.0, orientation.w, params.scaled != 0u);
    // The gradient is (t.y, -t.x); its sign means nothing.
    let upright = abs(t.x) > abs(t.y);
    let line = line_through(p, 0u, !upright, select(-t.x / t.y, -t.y / t.x, upright));
    let middle = fetch(lightness, 0u, p).xy;
    var sums: Sums;
    if line_inside(line, 0u, i32(min(params.halfwidth * factor, MOST_REACH))) {
        sums = gather(line, middle, factor, true);
    } else {
        sums = gather(line, middle, factor, false);
    }
    let u = dog_of_sums(sums.narrow, sums.wide, params.base, params.edge);
    textureStore(target_image, vec2i(id.xy), vec4f(u * middle.y, middle.y, 0.0, 0.0));
}
