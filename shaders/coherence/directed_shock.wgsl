// The gradient-directed shock filter (Listings 6.1 and 6.2): the pixel along the major eigenvector whose
// luma is least or greatest, chosen by the sign of a second derivative.
// Cost: per step of the derivative four loads and about 25 multiply-adds, and at most four loads per step of
// the radius.
#import gpu/line
#import shared/tensor

struct Params {
    /// Standard deviation of the second derivative, pixels.
    sigma: f32,
    /// Distance of its last tap, pixels.
    reach: f32,
    /// Distance of the last pixel looked at, pixels of the full-size picture.
    radius: f32,
    /// Pixels per pixel of the full-size picture.
    scale: f32,
    /// Responses up to this leave a pixel alone.
    threshold: f32,
}

#params
#input source, tensors
// What the derivative is taken of.
#input smooth_source
#output target_image rgba32float

// A line through a pixel (Fig. 3.9).
struct PixelSteps {
    line: Line,
    // Absolute component of its direction on the axis of its steps.
    share: f32,
}

// The line through pixel p in the direction `n`, a unit vector of either sign.
fn pixel_steps(p: vec2i, n: vec2f) -> PixelSteps {
    let along_x = abs(n.x) > abs(n.y);
    let major = select(n.y, n.x, along_x);
    return PixelSteps(line_through(p, 2u, along_x, select(n.x, n.y, along_x) / major), abs(major));
}

// The pixel `along` steps on and `across` pixels to the side.
fn pixel_on(line: Line, along: i32, across: i32) -> vec2i {
    return line.pixel + select(vec2i(across, along), vec2i(along, across), line.along_x);
}

fn luma(rgb: vec3f) -> f32 {
    return dot(rgb, vec3f(0.2126, 0.7152, 0.0722));
}

// Luma times coverage, and coverage.
fn covered_luma(v: vec4f) -> vec2f {
    return vec2f(luma(v.rgb) * v.a, v.a);
}

// By how much the luma `along` steps on exceeds that of the centre; transparent taps stand for the centre.
fn difference(line: Line, along: i32, centre: f32, inside: bool) -> f32 {
    let tap = line_tap(smooth_source, 2u, line, along, inside);
    let a = covered_luma(tap.a);
    let v = a + (covered_luma(tap.b) - a) * tap.f;
    return v.x - v.y * centre;
}

// The sum over both sides of the line, of steps of length `step`.
fn gather(line: Line, steps: i32, step: f32, inside: bool) -> f32 {
    let centre = luma(fetch(smooth_source, 2u, line.pixel).rgb);
    let variance = params.sigma * params.sigma;
    // exp(-d^2 / 2 sigma^2) at d = k step, from one step to the next.
    let falloff = exp2(-0.72134752 * step * step / variance);
    var gaussian = falloff;
    var ratio = falloff * falloff * falloff;
    var sum = 0.0;
    for (var k = 1; k <= steps; k++) {
        let d = f32(k) * step;
        let both = difference(line, k, centre, inside) + difference(line, -k, centre, inside);
        sum += (d * d - variance) * gaussian * both;
        gaussian *= ratio;
        ratio *= falloff * falloff;
    }
    return sum;
}

// The scale-normalised second derivative of a Gaussian of the luma along the line (Listing 6.1): negative about
// maxima, positive about minima.
fn flow_log(through: PixelSteps) -> f32 {
    let step = 1.0 / through.share;
    let steps = i32((params.reach + 1e-3) * through.share);
    var sum: f32;
    if line_inside(through.line, 2u, steps) {
        sum = gather(through.line, steps, step, true);
    } else {
        sum = gather(through.line, steps, step, false);
    }
    // Weights sum to zero by taking differences to the centre, so flat parts respond with exactly 0.
    return sum * step / (2.5066283 * (params.sigma * params.sigma) * params.sigma);
}

// The pixel whose luma, times the sign, is greatest among those looked at.
struct Found {
    extreme: f32,
    best: vec4f,
}

// Looks at the pixel `along` steps on and `across` to the side. One covered less than `least`, much less than the
// centre, knows little of its own colour.
fn look_at(found: ptr<function, Found>, line: Line, along: i32, across: f32, sign: f32, least: f32) {
    let v = fetch(source, 0u, pixel_on(line, along, i32(floor(across))));
    let value = sign * luma(v.rgb);
    if value > (*found).extreme && v.a >= least {
        *found = Found(value, v);
    }
}

// Looks at the pixels on both sides of the line, one and the same where it meets a centre.
fn look_beside(found: ptr<function, Found>, line: Line, along: i32, sign: f32, least: f32) {
    let across = f32(along) * line.slope;
    look_at(found, line, along, across + 0.999, sign, least);
    look_at(found, line, along, across + 0.001, sign, least);
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = pixel(id);
    let tensor = fetch(tensors, 1u, p);
    let through = pixel_steps(p, tensor_axis((tensor.x - tensor.z) * 0.5, tensor.y).major);
    let line = through.line;
    let z = flow_log(through);
    let origin = fetch(source, 0u, p);
    var best = origin;
    if abs(z) > params.threshold {
        // Above the threshold lies the zone of a minimum: erode. Below its opposite: dilate.
        let sign = select(1.0, -1.0, z > 0.0);
        let wanted = floor((params.radius + 1e-3) * through.share) * params.scale;
        let steps = i32(ceil(wanted));
        var found = Found(sign * luma(origin.rgb), origin);
        var whole = origin;
        for (var k = 1; k <= steps; k++) {
            if f32(k) > wanted {
                // The last step counts by its share.
                whole = found.best;
            }
            look_beside(&found, line, k, sign, 0.5 * origin.a);
            look_beside(&found, line, -k, sign, 0.5 * origin.a);
        }
        best = found.best;
        if f32(steps) > wanted {
            best = whole + (best - whole) * (wanted - floor(wanted));
        }
    }
    textureStore(target_image, vec2i(id.xy), vec4f(best.rgb, origin.a));
}
