// Adds lines where geometry breaks to the response of the first pass of the flow-based difference of
// Gaussians: across the tangent, it finds the breaks of normal, depth or object id between successive
// pixels, and takes a difference of Gaussians of their density off the response. The second pass then
// smooths both kinds of lines along the same flow. Lines are centred on the break; where breaks are as
// dense as the pixels nothing stands out, and no line is drawn. Creases as dense as lines are wide fade.
//
// Creases, outlines, and borders between things that touch have widths and strengths of their own.
// Cost: up to 3 loads and seven exponentials per step, 12 sigma_e steps.
#import gpu/grid
#import shared/breaks
#import shared/tensor

struct Params {
    /// -1 / (2 sigma^2) of the narrower Gaussian, of creases, of outlines and of borders between things that touch.
    narrow: vec4f,
    /// The same of the wider Gaussian.
    wide: vec4f,
    /// Cut-off, in pixels.
    halfwidth: vec4f,
    /// Units of response that a unit of the difference takes off.
    amount: vec4f,
    /// Steps on each side that the longest cut-off takes at most.
    steps: i32,
    /// Bit 0: normal, bit 1: depth, bit 2: object id are there. Bit 3: borders between things that touch are no outlines.
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

// Creases within a line's reach on each of its sides, counted by the wider Gaussian, from which on they
// are fainter, and at which none is drawn.
const FEW: f32 = 0.8;
const MANY: f32 = 1.5;

fn normal_at(p: vec2i) -> vec3f {
    return known_normal(fetch(normal, 2u, p));
}

fn depth_at(p: vec2i) -> f32 {
    return known_depth(fetch(depth, 3u, p).x);
}

fn id_at(p: vec2i) -> f32 {
    return known_id(fetch(object_id, 4u, p).x);
}

// The pixel nearest to the place k steps along the main axis and k * slope across it. Ties are
// decided off the middle, so that rounding does not.
fn place(p: vec2i, upright: bool, k: i32, slope: f32) -> vec2i {
    let i = i32(floor(f32(k) * slope + 0.502));
    return p + select(vec2i(k, i), vec2i(i, k), upright);
}

// True where the surfaces at places k and k + 1 touch.
fn touches(p: vec2i, upright: bool, k: i32, slope: f32) -> bool {
    let nearnesses = vec4f(
        nearness(depth_at(place(p, upright, k - 3, slope))),
        nearness(depth_at(place(p, upright, k - 1, slope))),
        nearness(depth_at(place(p, upright, k + 2, slope))),
        nearness(depth_at(place(p, upright, k + 4, slope))),
    );
    return depth_apart(nearnesses) < APART;
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
    let halfwidth = max(max(params.halfwidth.x, params.halfwidth.y), params.halfwidth.z);
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
    // Creases on one side.
    var before = 0.0;
    // Of borders of object ids alone (narrow, wide).
    var touching = vec2f(0.0);
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
        let d = (f32(k) + 0.5) * ds;
        if (params.guides & 4u) != 0u {
            let id_next = id_at(next);
            found.w = select(0.0, 1.0, id_next != id_here);
            id_here = id_next;
            if (params.guides & 8u) != 0u {
                let falloff = exp(vec2f(params.narrow.z, params.wide.z) * d * d);
                let weights = select(vec2f(0.0), falloff, abs(d) <= params.halfwidth.z);
                if found.w > 0.0 && touches(p, upright, k, slope) {
                    // A border is neither an outline nor a crease as well.
                    touching += weights;
                    found.w = 0.0;
                    found.x = 0.0;
                }
            }
        }
        let near = abs(vec2f(d)) <= params.halfwidth.xy;
        let n = select(vec2f(0.0), exp(params.narrow.xy * d * d), near);
        let w = select(vec2f(0.0), exp(params.wide.xy * d * d), near);
        narrow += n.xyyy * found;
        wide += w.xyyy * found;
        if k < 0 {
            before = wide.x;
        }
    }
    // The weights are the same on both sides. Added up here they take no room beside what is read above.
    var narrow_weights = vec3f(0.0);
    var wide_weights = vec3f(0.0);
    for (var k = 0; k < steps; k++) {
        let d = (f32(k) + 0.5) * ds;
        let near = vec3f(abs(d)) <= params.halfwidth.xyz;
        narrow_weights += select(vec3f(0.0), exp(params.narrow.xyz * d * d), near);
        wide_weights += select(vec3f(0.0), exp(params.wide.xyz * d * d), near);
    }
    narrow_weights = max(2.0 * narrow_weights, vec3f(1e-20));
    wide_weights = max(2.0 * wide_weights, vec3f(1e-20));
    let ridge = max(narrow / narrow_weights.xyyy - wide / wide_weights.xyyy, vec4f(0.0));
    let outline = max(max(ridge.y, ridge.z), ridge.w);
    let border = max(touching.x / narrow_weights.z - touching.y / wide_weights.z, 0.0);
    // A lone break is the fainter the wider it is smoothed.
    let evened = select(sqrt(factor), factor, factor >= 1.0);
    let sparseness = 1.0 - smoothstep(FEW, MANY, min(before, wide.x - before));
    let sharp = max(params.amount.x * ridge.x * sparseness, params.amount.y * outline);
    let strength = evened * max(sharp, params.amount.z * border);
    let v = fetch(response, 0u, p).xy;
    textureStore(target_image, vec2i(id.xy), vec4f(v.x - strength * v.y, v.y, 0.0, 0.0));
}
