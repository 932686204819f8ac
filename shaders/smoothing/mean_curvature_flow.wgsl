// One step of mean curvature flow (6.1), by harmonic averaging, or of its constrained variant (6.2).
// Cost: 4 loads, 30 reads of workgroup memory, four divisions and about 120 multiply-adds; the constraint
// takes 30 more.
#import shared/tensor
#import gpu/window

struct Params {
    /// Time step.
    time_step: f32,
    /// r of 6.2; with 0 the tensors are not read.
    constraint: f32,
}

#params
#input source, tensors
#output target_image rgba32float

// Gradients below this count as flat, where the flow is plain diffusion.
const EPSILON2: f32 = 1e-6;

const WINDOW_PIXELS: i32 = WINDOW_SMALL;

fn window_tap(p: vec2i) -> vec4f {
    let v = fetch(source, 0u, p);
    return vec4f(v.rgb * v.a, v.a);
}

// Central difference of the colour on one axis, times the squared coverage.
fn slope(before: vec4f, centre: vec4f, after: vec4f) -> vec3f {
    return 0.5 * (centre.a * (after.rgb - before.rgb) - centre.rgb * (after.a - before.a));
}

// Of the gradient at offset o.
fn magnitude(part: WindowPart, o: vec2i) -> f32 {
    let centre = window_read(part, o);
    let x = slope(window_read(part, o - vec2i(1, 0)), centre, window_read(part, o + vec2i(1, 0)));
    let y = slope(window_read(part, o - vec2i(0, 1)), centre, window_read(part, o + vec2i(0, 1)));
    return sqrt(dot(x, x) + dot(y, y) + EPSILON2);
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    let p = group_pixel(id);
    let part = window_load(id, vec2i(-2), vec2i(2));
    let origin = fetch(source, 0u, p);
    let steps = array(vec2i(-1, 0), vec2i(1, 0), vec2i(0, -1), vec2i(0, 1));
    let own = magnitude(part, vec2i(0));
    // Colours towards the neighbours, and how much.
    var sum = vec4f(0.0);
    for (var i = 0u; i < 4u; i++) {
        let v = window_read(part, steps[i]);
        let share = 2.0 * own / (own + magnitude(part, steps[i]));
        sum += share * vec4f(v.rgb - origin.rgb * v.a, v.a);
    }
    var speed = params.time_step;
    if params.constraint > 0.0 {
        let t = tensor_tangent(fetch(tensors, 1u, p));
        let centre = window_read(part, vec2i(0));
        let x = slope(window_read(part, vec2i(-1, 0)), centre, window_read(part, vec2i(1, 0)));
        let y = slope(window_read(part, vec2i(0, -1)), centre, window_read(part, vec2i(0, 1)));
        let across = x * t.y - y * t.x;
        let aligned = sqrt((dot(across, across) + EPSILON2) / (dot(x, x) + dot(y, y) + EPSILON2));
        speed *= 1.0 + params.constraint * (aligned - 1.0);
    }
    // Never beyond the mean of the neighbours.
    speed = min(speed, 1.0 / max(sum.a, 1e-6));
    if !outside(id) {
        textureStore(target_image, vec2i(id.xy), vec4f(origin.rgb + speed * sum.rgb, origin.a));
    }
}
