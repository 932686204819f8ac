#import gpu/grid
#import shared/tensor

// Stream lines after Cabral and Leedom (thesis § 2.9.4): straight through each pixel, along the minor
// eigenvector of the pixel's own tensor, to the pixel's boundary. Twin of kernels/shared/pixel_line.rs.
//
// The pixel is kept apart from the position, in whole numbers: positions lie on boundaries exactly, and
// the small correction of (2.191), which is to bring them inside, is not needed. Where the tensor behind a
// boundary leads straight back, the line follows the boundary. A line is traced like this:
//
//   var line = pixel_line_begin(pixel(id), side * tangent);
//   for (var i = 0; i < pixel_line_steps(limit) && u < limit; i++) {
//       let h = pixel_line_aim(&line, field, slot);
//       ... the line runs through line.pixel for h pixels ...
//       if !pixel_line_cross(&line, slot, h) { break; }
//   }

struct PixelLine {
    // Where the line has come to, absolute: on the boundary of `pixel`, or at its centre.
    position: vec2f,
    // The pixel that the line runs through next.
    pixel: vec2i,
    // Direction of the last segment; the next one takes the sign that turns less.
    direction: vec2f,
    // Per axis, the direction in which the last boundary was crossed: -1, 0 or 1.
    entered: vec2f,
    // Cosine of the angle between the last two directions, 0..1.
    turn: f32,
    // Distance to the next boundary across x and across y.
    exits: vec2f,
}

// Distance to a boundary that is not met.
const PIXEL_LINE_FAR: f32 = 1e6;
// Boundaries that are met within this distance are crossed at once.
const PIXEL_LINE_CORNER: f32 = 1e-4;

// A line from the centre of pixel p towards `direction`.
fn pixel_line_begin(p: vec2i, direction: vec2f) -> PixelLine {
    return PixelLine(vec2f(p) + 0.5, p, direction, vec2f(0.0), 1.0, vec2f(0.0));
}

// More segments than any line of that length has, unless it circles a point.
fn pixel_line_steps(limit: f32) -> i32 {
    return i32(4.0 * limit) + 16;
}

// Finds the direction through the current pixel (2.188); returns the length of the segment (2.190).
fn pixel_line_aim(line: ptr<function, PixelLine>, field: texture_2d<f32>, slot: u32) -> f32 {
    var t = tensor_tangent(fetch(field, slot, (*line).pixel));
    let along = dot((*line).direction, t);
    t = select(t, -t, along < 0.0);
    let back = (*line).entered * t < vec2f(0.0);
    if back.x {
        t = vec2f(0.0, select(-1.0, 1.0, t.y >= 0.0));
    } else if back.y {
        t = vec2f(select(-1.0, 1.0, t.x >= 0.0), 0.0);
    }
    let ahead = vec2f((*line).pixel) + select(vec2f(0.0), vec2f(1.0), t > vec2f(0.0));
    let moves = abs(t) > vec2f(1e-6);
    let exits = max((ahead - (*line).position) / select(vec2f(1.0), t, moves), vec2f(0.0));
    (*line).direction = t;
    (*line).turn = min(abs(along), 1.0);
    (*line).exits = select(vec2f(PIXEL_LINE_FAR), exits, moves);
    return min((*line).exits.x, (*line).exits.y);
}

// Goes on to the next pixel, `h` away; false when that lies outside the picture of input `slot`.
fn pixel_line_cross(line: ptr<function, PixelLine>, slot: u32, h: f32) -> bool {
    let t = (*line).direction;
    let crossed = (*line).exits <= vec2f(h + PIXEL_LINE_CORNER);
    (*line).entered = select(vec2f(0.0), select(vec2f(-1.0), vec2f(1.0), t > vec2f(0.0)), crossed);
    let boundary = vec2f((*line).pixel) + select(vec2f(0.0), vec2f(1.0), t > vec2f(0.0));
    (*line).position = select((*line).position + h * t, boundary, crossed);
    (*line).pixel += vec2i((*line).entered);
    return all((*line).pixel >= vec2i(0)) && all((*line).pixel < grid.inputs[slot].zw);
}

// The error function of x >= 0, error below 2e-6 (Abramowitz and Stegun 7.1.28).
fn error_function(x: f32) -> f32 {
    let p = 1.0 + x * (0.0705230784 + x * (0.0422820123 + x * (0.0092705272
        + x * (0.0001520143 + x * (0.0002765672 + x * 0.0000430638)))));
    let p2 = p * p;
    let p4 = p2 * p2;
    let p8 = p4 * p4;
    return 1.0 - 1.0 / (p8 * p8);
}
