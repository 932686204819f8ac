#import sampling
#import tensor

// Stream lines of the minor eigenvectors of a tensor field (thesis § 2.9, Listing 2.6).
// Twin of kernels/stream_line.rs.
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
// Every tensor is then read within `radius` of the centre, or h / 2 further by Adams' and Bashforth's method: a
// kernel's support is floor(radius) + 1 for steps of one pixel.

struct Stream {
    // Where the line has come to, absolute.
    position: vec2f,
    // Unit vector of the last step; the next one takes the sign that turns less.
    direction: vec2f,
    // Cosine of the angle between the last two steps, 0..1 up to rounding.
    turn: f32,
    // True until the first step, whose tangent is already known.
    begins: bool,
}

// Unit minor eigenvector at p, of either sign.
fn stream_tangent(field: texture_2d<f32>, slot: u32, p: vec2f) -> vec2f {
    return tensor_tangent(sample_linear(field, slot, p));
}

// A line that starts at p towards the unit vector `direction`, which is the tangent at p or its opposite.
fn stream_begin(p: vec2f, direction: vec2f) -> Stream {
    return Stream(p, direction, 1.0, true);
}

// The same on the side of the unit vector `direction`.
fn stream_tangent_along(field: texture_2d<f32>, slot: u32, p: vec2f, direction: vec2f) -> Along {
    let tensor = sample_linear(field, slot, p);
    return tensor_tangent_along(tensor.x - tensor.z, tensor.y, direction);
}

// Euler's method (2.176, 2.177).
const STREAM_EULER = 0u;
// The midpoint method, a second-order Runge-Kutta method (2.182).
const STREAM_MIDPOINT = 1u;
// The two-step method of Adams and Bashforth, of second order as well; its first step is the midpoint
// method's.
const STREAM_ADAMS_BASHFORTH = 2u;

// Moves by `h` pixels.
fn stream_step(line: ptr<function, Stream>, field: texture_2d<f32>, slot: u32, h: f32, integrator: u32) {
    let from_here = (*line).position;
    let last = (*line).direction;
    let begins = (*line).begins;
    var next = Along(last, 1.0);
    if !begins {
        next = stream_tangent_along(field, slot, from_here, last);
    }
    if integrator == STREAM_ADAMS_BASHFORTH && !begins {
        let there = (1.5 * h) * next.tangent + ((-0.5 * h) * last + from_here);
        *line = Stream(there, next.tangent, next.cosine, false);
        return;
    }
    if integrator != STREAM_EULER {
        next = stream_tangent_along(field, slot, from_here + (0.5 * h) * next.tangent, last);
    }
    // After its first step the two-step method still asks for the tangent at the beginning.
    let direction = select(next.tangent, last, integrator == STREAM_ADAMS_BASHFORTH);
    *line = Stream(from_here + h * next.tangent, direction, next.cosine, false);
}

// True when p has left the picture of input `slot`.
fn stream_outside(slot: u32, p: vec2f) -> bool {
    return any(p < vec2f(0.0)) || any(p >= vec2f(grid.inputs[slot].zw));
}
