// Adds lines where geometry breaks to the response of the first pass of the flow-based difference of
// Gaussians: across the tangent, it finds the breaks of normal, depth or object id between successive
// pixels, and takes a difference of Gaussians of their density off the response. The second pass then
// smooths both kinds of lines along the same flow. Lines are centred on the break; where breaks are as
// dense as the pixels nothing stands out, and no line is drawn.
//
// normal: 1 - cos of the angle. depth: 1/z is linear in x and y over any plane, so |z0/z+ + z0/z- - 2|
// is 0 on planes however slanted, and has no scale. object id: different or not.
// Creases and outlines have widths and strengths of their own.
// Cost: up to 3 loads and four exponentials per step, 12 sigma_e steps.
#import gpu/grid
#import shared/tensor

struct Params {
    /// -1 / (2 sigma^2) of the narrower Gaussian, of creases and of outlines.
    narrow: vec2f,
    /// The same of the wider Gaussian.
    wide: vec2f,
    /// Cut-off, in pixels.
    halfwidth: vec2f,
    /// Units of response that a unit of the difference takes off.
    amount: vec2f,
    /// Steps on each side that the longer cut-off takes at most.
    steps: i32,
    /// Bit 0: normal, bit 1: depth, bit 2: object id are there.
    guides: u32,
    /// 1: the fourth channel of the field is a factor on the widths.
    scaled: u32,
}

#params
#input response
// (E - G, F), see orientation_field, or with a factor, see control_field.
#input field
#input normal, depth, object_id
#output target_image rg32float

// False for NaN and infinities, by bits: shader compilers may assume that they do not exist.
fn is_finite(v: f32) -> bool {
    return (bitcast<u32>(v) & 0x7f800000u) != 0x7f800000u;
}

// The normal, all zero where there is none.
fn normal_at(p: vec2i) -> vec3f {
    let v = fetch(normal, 2u, p);
    let valid = is_finite(v.x) && is_finite(v.y) && is_finite(v.z) && v.w > 0.5;
    return select(vec3f(0.0), v.xyz, valid);
}

// Depth, 0 where there is nothing.
fn depth_at(p: vec2i) -> f32 {
    let z = fetch(depth, 3u, p).x;
    return select(0.0, z, is_finite(z) && z > 0.0);
}

fn id_at(p: vec2i) -> f32 {
    let v = fetch(object_id, 4u, p).x;
    return select(0.0, v, is_finite(v));
}

// How far two directions differ, 0 for equal and 1 for perpendicular ones, and 1 where one is missing and the other not.
fn normal_break(a: vec3f, b: vec3f) -> vec2f {
    let aa = dot(a, a);
    let bb = dot(b, b);
    if aa <= 0.0 || bb <= 0.0 {
        return vec2f(0.0, select(0.0, 1.0, aa > 0.0 || bb > 0.0));
    }
    let turn = 1.0 - dot(a, b) / sqrt(aa * bb);
    // Below 10 degrees a pixel it is relief of the surface, from 31 degrees on an edge.
    let t = clamp((turn - 0.015) * 8.0, 0.0, 1.0);
    return vec2f(t * t * (3.0 - 2.0 * t), 0.0);
}

// Nearness relative to the pixel itself, 0..2; two empty places are equally near.
fn relative_nearness(z0: f32, z: f32) -> f32 {
    if z0 <= 0.0 {
        return select(1.0, 2.0, z > 0.0);
    }
    return select(0.0, min(z0 / z, 2.0), z > 0.0);
}

// How far depth at the middle one of three pixels is from a plane through its neighbours.
fn depth_bend(before: f32, z0: f32, after: f32) -> f32 {
    return abs(relative_nearness(z0, before) + relative_nearness(z0, after) - 2.0);
}

// Both pixels at a jump lie off the plane of their neighbours.
fn depth_break(bend: f32, next_bend: f32) -> f32 {
    // A step of 2 % is relief, one of 12 % an edge.
    let t = clamp((min(bend, next_bend) - 0.02) * 10.0, 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}

// The pixel nearest to the place k steps along the main axis and k * slope across it. Ties are
// decided off the middle, so that rounding does not.
fn place(p: vec2i, upright: bool, k: i32, slope: f32) -> vec2i {
    let i = i32(floor(f32(k) * slope + 0.502));
    return p + select(vec2i(k, i), vec2i(i, k), upright);
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = pixel(id);
    let orientation = fetch(field, 1u, p);
    let t = tensor_tangent(orientation);
    let factor = select(1.0, orientation.w, params.scaled != 0u);
    let upright = abs(t.x) > abs(t.y);
    let slope = select(-t.x / t.y, -t.y / t.x, upright);
    // Against the width that is asked for.
    let ds = sqrt(1.0 + slope * slope) / factor;

    // Breaks between pixels k and k + 1 along the line; depth looks one further on either side.
    let halfwidth = max(params.halfwidth.x, params.halfwidth.y);
    let steps = select(params.steps, min(i32(halfwidth * factor + 0.5), params.steps), params.scaled != 0u);
    let first = -steps;
    let start = place(p, upright, first, slope);
    var normal_here = vec3f(0.0);
    var id_here = 0.0;
    var depth_here = 0.0;
    var depth_next = 0.0;
    var bend_here = 0.0;
    if (params.guides & 1u) != 0u {
        normal_here = normal_at(start);
    }
    if (params.guides & 2u) != 0u {
        depth_here = depth_at(start);
        depth_next = depth_at(place(p, upright, first + 1, slope));
        bend_here = depth_bend(depth_at(place(p, upright, first - 1, slope)), depth_here, depth_next);
    }
    if (params.guides & 4u) != 0u {
        id_here = id_at(start);
    }
    // Of creases, which lie between two normals, and of outlines: borders of normals, depth and object id.
    var narrow = vec4f(0.0);
    var wide = vec4f(0.0);
    var narrow_weights = vec2f(0.0);
    var wide_weights = vec2f(0.0);
    for (var k = first; k < steps; k++) {
        let next = place(p, upright, k + 1, slope);
        var found = vec4f(0.0);
        if (params.guides & 1u) != 0u {
            let normal_next = normal_at(next);
            let broken = normal_break(normal_here, normal_next);
            found.x = broken.x;
            found.y = broken.y;
            normal_here = normal_next;
        }
        if (params.guides & 2u) != 0u {
            let after = depth_at(place(p, upright, k + 2, slope));
            let bend_next = depth_bend(depth_here, depth_next, after);
            found.z = depth_break(bend_here, bend_next);
            depth_here = depth_next;
            depth_next = after;
            bend_here = bend_next;
        }
        if (params.guides & 4u) != 0u {
            let id_next = id_at(next);
            found.w = select(0.0, 1.0, id_next != id_here);
            id_here = id_next;
        }
        let d = (f32(k) + 0.5) * ds;
        let near = abs(vec2f(d)) <= params.halfwidth;
        let n = select(vec2f(0.0), exp(params.narrow * d * d), near);
        let w = select(vec2f(0.0), exp(params.wide * d * d), near);
        narrow += n.xyyy * found;
        wide += w.xyyy * found;
        narrow_weights += n;
        wide_weights += w;
    }
    let ridge = max(narrow / narrow_weights.xyyy - wide / wide_weights.xyyy, vec4f(0.0));
    let outline = max(max(ridge.y, ridge.z), ridge.w);
    // A lone break is the fainter the wider it is smoothed.
    let evened = select(sqrt(factor), factor, factor >= 1.0);
    let strength = evened * max(params.amount.x * ridge.x, params.amount.y * outline);
    let v = fetch(response, 0u, p).xy;
    textureStore(target_image, vec2i(id.xy), vec4f(v.x - strength * v.y, v.y, 0.0, 0.0));
}
