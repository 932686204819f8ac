// A map of rules for things as lines and paint follow it: beside a nearer thing its values count, and what an artist painted
// refines them.
// Cost: 2 reach + 3 loads.
#import gpu/grid
#import shared/breaks

struct Params {
    /// Rows to both sides in which a nearer thing counts; 0 where depth is not known.
    reach: u32,
    /// What is painted: 0 nothing, 1 a control map, 2 colours of lines.
    painted: u32,
}

#params
// The map, depth, its nearest ones across, and what is painted.
#input rules, depth, across, painted
#output target_image rgba32float

// Depth of what is not there.
const FAR: f32 = 3e38;
// Part of a depth from which on something is farther away.
const BEHIND: f32 = 0.01;

// Place of the thing whose rules count at p.
fn of_thing(p: vec2i) -> vec2i {
    if params.reach == 0u {
        return p;
    }
    let full = grid.inputs[2].zw;
    var nearest = vec3f(fetch(across, 2u, p).xy, 0.0);
    for (var by = 1; by <= i32(params.reach); by++) {
        for (var side = -1; side <= 1; side += 2) {
            let found = fetch(across, 2u, p + vec2i(0, side * by)).xy;
            if found.x < nearest.x {
                nearest = vec3f(found, f32(side * by));
            }
        }
    }
    let z = known_depth(fetch(depth, 1u, p).x);
    let own = select(z, FAR, z <= 0.0);
    let is_behind = nearest.x < own * (1.0 - BEHIND);
    return select(p, clamp(p + vec2i(nearest.yz), vec2i(0), full - 1), is_behind);
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = pixel(id);
    var value = fetch(rules, 0u, of_thing(p));
    if params.painted == 1u {
        let v = fetch(painted, 3u, p);
        let known = vec4<bool>(is_finite(v.x), is_finite(v.y), is_finite(v.z), is_finite(v.w));
        let hand = select(vec4f(0.5), clamp(v, vec4f(0.0), vec4f(1.0)), known);
        let refined = clamp(value + hand - 0.5, vec4f(0.0), vec4f(1.0));
        // Where there are to be no lines there are none.
        value = select(refined, value, vec4<bool>(false, false, value.z == 0.0, false));
    } else if params.painted == 2u {
        let hand = fetch(painted, 3u, p);
        let share = clamp(hand.a, 0.0, 1.0);
        let alpha = share + value.a * (1.0 - share);
        let colour = hand.rgb * share + value.rgb * value.a * (1.0 - share);
        value = vec4f(select(value.rgb, colour / alpha, alpha > 0.0), alpha);
    }
    textureStore(target_image, vec2i(id.xy), value);
}
