// The gradient-directed shock filter (Listings 6.1 and 6.2): the pixel along the major eigenvector whose
// luma is least or greatest, chosen by the sign of a second derivative.
// Cost: per step of the derivative four loads and about 25 multiply-adds, and at most four loads per step of
// the radius.
#import gpu/grid
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

@group(0) @binding(1) var<uniform> params: Params;
@group(0) @binding(2) var source: texture_2d<f32>;
@group(0) @binding(3) var tensors: texture_2d<f32>;
// What the derivative is taken of.
@group(0) @binding(4) var smooth_source: texture_2d<f32>;
@group(0) @binding(5) var target_image: texture_storage_2d<rgba32float, write>;

// A line through a pixel, in steps of one pixel along the axis nearer to its direction (Fig. 3.9).
struct PixelSteps {
    along_x: bool,
    // Absolute component of the direction on that axis.
    share: f32,
    // Pixels on the other axis per pixel on that one.
    slope: f32,
}

// The line in the direction `n`, a unit vector of either sign.
fn pixel_steps(n: vec2f) -> PixelSteps {
    let along_x = abs(n.x) > abs(n.y);
    let major = select(n.y, n.x, along_x);
    return PixelSteps(along_x, abs(major), select(n.x, n.y, along_x) / major);
}

// The pixel `along` steps on and `across` pixels to the side.
fn pixel_on(p: vec2i, line: PixelSteps, along: i32, across: i32) -> vec2i {
    return p + select(vec2i(across, along), vec2i(along, across), line.along_x);
}

fn luma(rgb: vec3f) -> f32 {
    return dot(rgb, vec3f(0.2126, 0.7152, 0.0722));
}

// Luma times coverage, and coverage.
fn tap(p: vec2i) -> vec2f {
    let v = fetch(smooth_source, 2u, p);
    return vec2f(luma(v.rgb) * v.a, v.a);
}

// By how much the luma `along` steps on exceeds that of the centre; transparent taps stand for the centre.
fn difference(p: vec2i, line: PixelSteps, along: i32, centre: f32) -> f32 {
    let across = f32(along) * line.slope;
    let i = floor(across);
    let a = tap(pixel_on(p, line, along, i32(i)));
    let b = tap(pixel_on(p, line, along, i32(i) + 1));
    let v = a + (b - a) * (across - i);
    return v.x - v.y * centre;
}

// The scale-normalised second derivative of a Gaussian of the luma along the line through pixel p (Listing 6.1):
// negative about maxima, positive about minima.
fn flow_log(p: vec2i, line: PixelSteps) -> f32 {
    let step = 1.0 / line.share;
    let steps = i32((params.reach + 1e-3) * line.share);
    let centre = luma(fetch(smooth_source, 2u, p).rgb);
    let variance = params.sigma * params.sigma;
    // exp(-d^2 / 2 sigma^2) at d = k step, from one step to the next.
    let falloff = exp2(-0.72134752 * step * step / variance);
    var gaussian = falloff;
    var ratio = falloff * falloff * falloff;
    var sum = 0.0;
    for (var k = 1; k <= steps; k++) {
        let d = f32(k) * step;
        let both = difference(p, line, k, centre) + difference(p, line, -k, centre);
        sum += (d * d - variance) * gaussian * both;
        gaussian *= ratio;
        ratio *= falloff * falloff;
    }
    // Weights sum to zero by taking differences to the centre, so flat parts respond with exactly 0.
    return sum * step / (2.5066283 * variance * params.sigma);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = pixel(id);
    let tensor = fetch(tensors, 1u, p);
    let line = pixel_steps(tensor_axis((tensor.x - tensor.z) * 0.5, tensor.y).major);
    let z = flow_log(p, line);
    let origin = fetch(source, 0u, p);
    var best = origin;
    if abs(z) > params.threshold {
        // Above the threshold lies the zone of a minimum: erode. Below its opposite: dilate.
        let sign = select(1.0, -1.0, z > 0.0);
        let wanted = floor((params.radius + 1e-3) * line.share) * params.scale;
        let steps = i32(ceil(wanted));
        var extreme = sign * luma(origin.rgb);
        var whole = best;
        for (var k = 1; k <= steps; k++) {
            if f32(k) > wanted {
                // The last step counts by its share.
                whole = best;
            }
            for (var side = 1; side >= -1; side -= 2) {
                let across = f32(side * k) * line.slope;
                for (var next = 0.999; next > 0.0; next -= 0.998) {
                    // The pixels on both sides of the line; one and the same where it meets a centre.
                    let v = fetch(source, 0u, pixel_on(p, line, side * k, i32(floor(across + next))));
                    let value = sign * luma(v.rgb);
                    // A pixel much less covered than this one knows little of its own colour.
                    if value > extreme && v.a >= 0.5 * origin.a {
                        extreme = value;
                        best = v;
                    }
                }
            }
        }
        if f32(steps) > wanted {
            best = whole + (best - whole) * (wanted - floor(wanted));
        }
    }
    textureStore(target_image, vec2i(id.xy), vec4f(best.rgb, origin.a));
}
