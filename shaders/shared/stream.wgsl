#import shared/sampling
#import shared/tensor

// Stream lines of the minor eigenvectors of a tensor field (thesis § 2.9, Listing 2.6).
// Twin of kernels/shared/stream.rs.
//
// Tensors are interpolated, never eigenvectors: those are defined up to sign, and opposite ones would
// cancel. A line is traced from its centre in one direction and then in the other:
//
//   var line = stream_begin(centre(id), side * stream_tangent(field, slot, centre(id)));
//   for (u = h; u <= radius; u += h) {
//       stream_step(&line, field, slot, h, integrator);
//       if stream_outside(slot, line.position) { break; }
//       ...
//   }
//
// Every tensor is then read within `radius` of the centre: a kernel's support is floor(radius) + 1 for steps of one pixel.

struct Stream {
    // Where the line has come to, absolute.
    position: vec2f,
    // Unit vector of the last step; the next one takes the sign that turns less.
    direction: vec2f,
    // Cosine of the angle between the last two steps, 0..1 up to rounding.
    turn: f32,
    // The tangent at the end of the last step, extrapolated by the two-step method.
    ahead: vec2f,
    // True until the first step, whose tangent is already known.
    begins: bool,
    // True where tensors of the nearest pixels are taken, not interpolated ones.
    nearest: bool,
}

// Unit minor eigenvector at p, of either sign.
fn stream_tangent(field: texture_2d<f32>, slot: u32, p: vec2f) -> vec2f {
    return tensor_tangent(sample_linear(field, slot, p));
}

// A line that starts at p towards the unit vector `direction`, which is the tangent at p or its opposite.
fn stream_begin(p: vec2f, direction: vec2f) -> Stream {
    return Stream(p, direction, 1.0, direction, true, false);
}

// The same on the side of the unit vector `direction`; at the `nearest` pixel's centre nothing is interpolated.
fn stream_tangent_along(field: texture_2d<f32>, slot: u32, p: vec2f, direction: vec2f, nearest: bool) -> Along {
    let tensor = sample_linear(field, slot, select(p, floor(p) + 0.5, nearest));
    return tensor_tangent_along(tensor.x - tensor.z, tensor.y, direction);
}

// Euler's method (2.176, 2.177).
const STREAM_EULER = 0u;
// The midpoint method, a second-order Runge-Kutta method (2.182).
const STREAM_MIDPOINT = 1u;
// The midpoint method with the tangent here extrapolated from those halfway through the last two steps; of second
// order too.
const STREAM_TWO_STEP = 2u;

// Moves by `h` pixels.
fn stream_step(line: ptr<function, Stream>, field: texture_2d<f32>, slot: u32, h: f32, integrator: u32) {
    let from_here = (*line).position;
    let last = (*line).direction;
    let begins = (*line).begins;
    var next = Along(select(last, (*line).ahead, integrator == STREAM_TWO_STEP), 1.0);
    if !begins && integrator != STREAM_TWO_STEP {
        next = stream_tangent_along(field, slot, from_here, last, (*line).nearest);
    }
    if integrator != STREAM_EULER {
        next = stream_tangent_along(field, slot, from_here + (0.5 * h) * next.tangent, last, (*line).nearest);
    }
    let ahead = next.tangent + select(0.5, 1.0, begins) * (next.tangent - last);
    *line = Stream(from_here + h * next.tangent, next.tangent, next.cosine, ahead, false, (*line).nearest);
}

// Lines of no more steps to a side keep theirs.
const STREAM_FEW = 3.0;

// The number of steps, stretched by up to `stretch`, that take the place of `steps`.
fn stream_few_steps(steps: f32, stretch: f32) -> f32 {
    return max(ceil(steps / stretch - 1e-3), min(steps, STREAM_FEW));
}

// By how much steps are longer when `few` of them take the place of `steps`: their rectangles fill the same
// length (2.187).
fn stream_stretched(steps: f32, few: f32) -> f32 {
    return (2.0 * steps + 1.0) / (2.0 * few + 1.0);
}

// True when p has left the picture of input `slot`.
fn stream_outside(slot: u32, p: vec2f) -> bool {
    return any(p < vec2f(0.0)) || any(p >= vec2f(grid.inputs[slot].zw));
}
