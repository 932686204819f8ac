#import shared/coverage

// Motion between frames: where a pixel's point is in another frame, from its own place. Twin of kernels/shared/motion.rs.

// Components of motions that are not known.
const UNKNOWN_MOTION: f32 = 1e9;

fn is_known(motion: vec2f) -> bool {
    return abs(motion.x) < 1e8;
}

// True for positions inside a picture of `size` pixels.
fn is_inside(p: vec2f, size: vec2i) -> bool {
    return all(p >= vec2f(0.0)) && all(p <= vec2f(size));
}

// The motion unless it is longer than `limit` or no number, which makes it unknown.
fn bounded_motion(motion: vec2f, limit: f32) -> vec2f {
    // By bits: shader compilers may assume that NaN does not exist.
    let special = (bitcast<vec2u>(motion) & vec2u(0x7f800000u)) == vec2u(0x7f800000u);
    let known = !any(special) && abs(motion.x) <= limit && abs(motion.y) <= limit;
    return select(vec2f(UNKNOWN_MOTION), motion, known);
}

// The motion at a place, as far as it is no longer than `limit`: interpolated where neighbours agree to a pixel, else
// that of the nearest.
fn motion_at(steps: texture_2d<f32>, slot: u32, place: vec2f, limit: f32) -> vec2f {
    let q = min(max(place - 0.5, vec2f(-2.0)), vec2f(grid.inputs[slot].zw) + 2.0);
    let corner = floor(q);
    let f = q - corner;
    let i = vec2i(corner);
    let a = bounded_motion(fetch(steps, slot, i).xy, limit);
    let b = bounded_motion(fetch(steps, slot, i + vec2i(1, 0)).xy, limit);
    let c = bounded_motion(fetch(steps, slot, i + vec2i(0, 1)).xy, limit);
    let d = bounded_motion(fetch(steps, slot, i + vec2i(1, 1)).xy, limit);
    let top = a + (b - a) * f.x;
    let bottom = c + (d - c) * f.x;
    let mean = top + (bottom - top) * f.y;
    // Across the border of a thing the motions on both sides have no mean: the nearest one holds.
    let spread = max(max(a, b), max(c, d)) - min(min(a, b), min(c, d));
    let near = bounded_motion(fetch(steps, slot, vec2i(floor(place))).xy, limit);
    return select(near, mean, max(spread.x, spread.y) <= 1.0);
}

// Weights of the four pixels around a share of the way from the second to the third: the cubic of Catmull and Rom.
fn catmull_rom(f: f32) -> vec4f {
    let g = 1.0 - f;
    return vec4f(
        -0.5 * f * g * g,
        1.0 + f * f * (1.5 * f - 2.5),
        1.0 + g * g * (1.5 * g - 2.5),
        -0.5 * g * f * f,
    );
}

// Sample of a colour image with a sharp interpolation, colours multiplied by their alpha.
fn sample_sharp_covered(image: texture_2d<f32>, slot: u32, p: vec2f) -> vec4f {
    let last = vec2f(grid.inputs[slot].zw);
    let q = min(max(p - 0.5, vec2f(-2.0)), last + 2.0);
    let corner = floor(q);
    let i = vec2i(corner);
    let wx = catmull_rom(q.x - corner.x);
    let wy = catmull_rom(q.y - corner.y);
    var sum = vec4f(0.0);
    for (var y = 0; y < 4; y++) {
        var row = vec4f(0.0);
        for (var x = 0; x < 4; x++) {
            row += wx[x] * fetch_covered(image, slot, i + vec2i(x - 1, y - 1));
        }
        sum += wy[y] * row;
    }
    return sum;
}

// Sample of any image with a sharp interpolation.
fn sample_sharp(image: texture_2d<f32>, slot: u32, p: vec2f) -> vec4f {
    let last = vec2f(grid.inputs[slot].zw);
    let q = min(max(p - 0.5, vec2f(-2.0)), last + 2.0);
    let corner = floor(q);
    let i = vec2i(corner);
    let wx = catmull_rom(q.x - corner.x);
    let wy = catmull_rom(q.y - corner.y);
    var sum = vec4f(0.0);
    for (var y = 0; y < 4; y++) {
        var row = vec4f(0.0);
        for (var x = 0; x < 4; x++) {
            row += wx[x] * fetch(image, slot, i + vec2i(x - 1, y - 1));
        }
        sum += wy[y] * row;
    }
    return sum;
}
