// One step of the variational refinement (Kroeger et al. 2016, 3.3; the terms are those of Brox et al. 2004): brightness
// and its gradient stay constant along the motion and the motion is smooth, all of them but for outliers.
// A Jacobi step with the robust weights of the step before, extrapolated (Hafner et al. 2016). Cost: 14 loads and
// about 200 operations.
#import gpu/grid

struct Params {
    /// How far the step goes from `before` through the solution of Jacobi's equations: 1 ends there.
    momentum: f32,
}

#params
#input first_image, second_image, start, before, now
#output target_image rg32float

// Weights of the gradient's constancy and of smoothness against that of the brightness.
const GRADIENT = 2.0;
const SMOOTHNESS = 3.0;
// Squares of what tells an outlier: of distances in pixels, and of differences of motions in pixels per pixel.
const OUTLIER = 1e-6;
const BREAK = 1e-4;
// Added to squared derivatives, levels of brightness: noise below it is no constraint.
const NOISE = 0.01;

fn before_at(p: vec2i) -> vec2f {
    return fetch(now, 4u, p).xy;
}

// Weight of smoothness across one side of a pixel, from the difference across it and the sum of four along it.
fn across(difference: vec2f, along: vec2f) -> f32 {
    let slope = 0.25 * along;
    return SMOOTHNESS / sqrt(dot(difference, difference) + dot(slope, slope) + BREAK);
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = pixel(id);
    let origin = fetch(start, 2u, p).xy;
    let centre = before_at(p);
    let left = before_at(p + vec2i(-1, 0));
    let right = before_at(p + vec2i(1, 0));
    let up = before_at(p + vec2i(0, -1));
    let down = before_at(p + vec2i(0, 1));
    let left_up = before_at(p + vec2i(-1, -1));
    let right_up = before_at(p + vec2i(1, -1));
    let left_down = before_at(p + vec2i(-1, 1));
    let right_down = before_at(p + vec2i(1, 1));

    let weights = vec4f(
        across(left - centre, (down - up) + (left_down - left_up)),
        across(right - centre, (down - up) + (right_down - right_up)),
        across(up - centre, (right - left) + (right_up - left_up)),
        across(down - centre, (right - left) + (right_down - left_down)),
    );
    var pull = weights.x * (left - origin) + weights.y * (right - origin);
    pull += weights.z * (up - origin) + weights.w * (down - origin);
    let stiffness = (weights.x + weights.y) + (weights.z + weights.w);

    // x, y, z and xx; xy, yy, xz and yz.
    let a = fetch(first_image, 0u, p);
    let b = fetch(second_image, 1u, p);
    let d = centre - origin;
    let steep = a.x * a.x + a.y * a.y + NOISE;
    let steep_x = a.w * a.w + b.x * b.x + NOISE;
    let steep_y = b.x * b.x + b.y * b.y + NOISE;
    let off = a.z + a.x * d.x + a.y * d.y;
    let off_x = b.z + a.w * d.x + b.x * d.y;
    let off_y = b.w + b.x * d.x + b.y * d.y;
    let brightness = 1.0 / (sqrt(off * off / steep + OUTLIER) * steep);
    let gradient = GRADIENT / sqrt(off_x * off_x / steep_x + off_y * off_y / steep_y + OUTLIER);
    let gradient_x = gradient / steep_x;
    let gradient_y = gradient / steep_y;

    let xx = brightness * a.x * a.x + gradient_x * a.w * a.w + gradient_y * b.x * b.x + stiffness;
    let xy = brightness * a.x * a.y + gradient_x * a.w * b.x + gradient_y * b.x * b.y;
    let yy = brightness * a.y * a.y + gradient_x * b.x * b.x + gradient_y * b.y * b.y + stiffness;
    let x = pull.x - (brightness * a.x * a.z + gradient_x * a.w * b.z + gradient_y * b.x * b.w);
    let y = pull.y - (brightness * a.y * a.z + gradient_x * b.x * b.z + gradient_y * b.y * b.w);
    let solution = origin + vec2f(yy * x - xy * y, xx * y - xy * x) / (xx * yy - xy * xy);

    let last = fetch(before, 3u, p).xy;
    textureStore(target_image, vec2i(id.xy), vec4f(last + params.momentum * (solution - last), 0.0, 0.0));
}
