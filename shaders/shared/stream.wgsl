#import shared/sampling
#import shared/tensor

// Stream lines of the minor eigenvectors of a tensor field (thesis § 2.9, Listing 2.6).
// Twin of kernels/shared/stream.rs.
//
// Tensors are interpolated, never eigenvectors: those are defined up to sign, and opposite ones would
// cancel. A line is traced from its centre in one direction and then in the other:
//
//   var line = stream_begin(centre(id), side * stream_tangent(field, slot, centre(id)), inside);
//   for (u = h; u <= radius; u += h) {
//       stream_step(&line, field, slot, h, integrator);
//       if stream_ends(line, slot) { break; }
//       ...
//   }
//
// Lines that cannot reach the picture's edge need no clamping: kernels where that counts have this in a function that
// is called once with `inside` as true and once as false, as stream_inside says.
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
    // True where the picture holds all that the line reads.
    inside: bool,
}

// Whether it does: of a line from absolute position p, no longer than `length`, in the picture of input `slot`.
fn stream_inside(slot: u32, p: vec2f, length: f32) -> bool {
    let room = vec2f(length + 2.0);
    return all(p >= room) && all(p + room <= vec2f(grid.inputs[slot].zw));
}

// The pixels around position p on the line.
fn stream_surroundings(line: Stream, slot: u32, p: vec2f) -> Surroundings {
    if line.inside {
        return surroundings_inside(slot, p);
    }
    return surroundings(slot, p);
}

// Unit minor eigenvector at p, of either sign.
fn stream_tangent(field: texture_2d<f32>, slot: u32, p: vec2f) -> vec2f {
    return tensor_tangent(sample_linear(field, slot, p));
}

// A line that starts at p towards the unit vector `direction`, which is the tangent at p or its opposite.
fn stream_begin(p: vec2f, direction: vec2f, inside: bool) -> Stream {
    return Stream(p, direction, 1.0, direction, true, false, inside);
}

// The unit minor eigenvector at p, turned to where the line goes; at the nearest pixel's centre nothing is
// interpolated.
fn stream_tangent_along(line: Stream, field: texture_2d<f32>, slot: u32, p: vec2f) -> Along {
    let place = select(p, floor(p) + 0.5, line.nearest);
    let tensor = sample_among(field, stream_surroundings(line, slot, place));
    return tensor_tangent_along(tensor.x - tensor.z, tensor.y, line.direction);
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
    let from_here = *line;
    let last = from_here.direction;
    var next = Along(select(last, from_here.ahead, integrator == STREAM_TWO_STEP), 1.0);
    if !from_here.begins && integrator != STREAM_TWO_STEP {
        next = stream_tangent_along(from_here, field, slot, from_here.position);
    }
    if integrator != STREAM_EULER {
        next = stream_tangent_along(from_here, field, slot, from_here.position + (0.5 * h) * next.tangent);
    }
    (*line).position = from_here.position + h * next.tangent;
    (*line).direction = next.tangent;
    (*line).turn = next.cosine;
    (*line).ahead = next.tangent + select(0.5, 1.0, from_here.begins) * (next.tangent - last);
    (*line).begins = false;
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

// True when the line has left the picture of input `slot`.
fn stream_ends(line: Stream, slot: u32) -> bool {
    return !line.inside && stream_outside(slot, line.position);
}
