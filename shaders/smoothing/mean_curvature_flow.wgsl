// One step of mean curvature flow (6.1), by harmonic averaging, or of its constrained variant (6.2).
// Cost: 25 loads, four divisions and about 120 multiply-adds; the constraint takes 30 more.
#import tensor
#import grid

struct Params {
    time_step: f32,
    // r of 6.2; with 0 the tensors are not read.
    constraint: f32,
}

@group(0) @binding(1) var<uniform> params: Params;
@group(0) @binding(2) var source: texture_2d<f32>;
@group(0) @binding(3) var tensors: texture_2d<f32>;
@group(0) @binding(4) var target_image: texture_storage_2d<rgba32float, write>;

// Gradients below this count as flat, where the flow is plain diffusion.
const EPSILON2: f32 = 1e-6;

fn covered(p: vec2i) -> vec4f {
    let v = fetch(source, 0u, p);
    return vec4f(v.rgb * v.a, v.a);
}

// Central difference of the colour on one axis, times the squared coverage.
fn slope(before: vec4f, centre: vec4f, after: vec4f) -> vec3f {
    return 0.5 * (centre.a * (after.rgb - before.rgb) - centre.rgb * (after.a - before.a));
}

fn magnitude(p: vec2i) -> f32 {
    let centre = covered(p);
    let x = slope(covered(p - vec2i(1, 0)), centre, covered(p + vec2i(1, 0)));
    let y = slope(covered(p - vec2i(0, 1)), centre, covered(p + vec2i(0, 1)));
    return sqrt(dot(x, x) + dot(y, y) + EPSILON2);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = pixel(id);
    let origin = fetch(source, 0u, p);
    let steps = array(vec2i(-1, 0), vec2i(1, 0), vec2i(0, -1), vec2i(0, 1));
    let own = magnitude(p);
    // Colours towards the neighbours, and how much.
    var sum = vec4f(0.0);
    for (var i = 0u; i < 4u; i++) {
        let q = p + steps[i];
        let v = covered(q);
        let share = 2.0 * own / (own + magnitude(q));
        sum += share * vec4f(v.rgb - origin.rgb * v.a, v.a);
    }
    var speed = params.time_step;
    if params.constraint > 0.0 {
        let t = tensor_tangent(fetch(tensors, 1u, p));
        let centre = covered(p);
        let x = slope(covered(p - vec2i(1, 0)), centre, covered(p + vec2i(1, 0)));
        let y = slope(covered(p - vec2i(0, 1)), centre, covered(p + vec2i(0, 1)));
        let across = x * t.y - y * t.x;
        let aligned = sqrt((dot(across, across) + EPSILON2) / (dot(x, x) + dot(y, y) + EPSILON2));
        speed *= 1.0 + params.constraint * (aligned - 1.0);
    }
    // Never beyond the mean of the neighbours.
    speed = min(speed, 1.0 / max(sum.a, 1e-6));
    textureStore(target_image, vec2i(id.xy), vec4f(origin.rgb + speed * sum.rgb, origin.a));
}
