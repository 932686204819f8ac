// Kinds of lines that geometry draws: densities of creases, of outlines, and of borders between things that touch, 1 at pixels
// that have a break to one of their four neighbours.
// Cost: 32 loads and about 150 operations.
#import gpu/grid
#import shared/breaks

struct Params {
    /// Bit 0: normal, bit 1: depth, bit 2: object id are there.
    guides: u32,
}

#params
#input normal, depth, object_id
#output target_image rgba32float

fn nearness_at(p: vec2i) -> f32 {
    return nearness(known_depth(fetch(depth, 1u, p).x));
}

// Breaks (crease, outline, border) between a pixel and the one at `step` from it.
fn breaks(p: vec2i, step: vec2i) -> vec3f {
    var found = vec3f(0.0);
    if (params.guides & 1u) != 0u {
        let here = known_normal(fetch(normal, 0u, p));
        let broken = normal_break(here, known_normal(fetch(normal, 0u, p + step)));
        found = vec3f(broken, 0.0);
    }
    var is_apart = false;
    if (params.guides & 2u) != 0u {
        let nearnesses = vec4f(nearness_at(p - 3 * step), nearness_at(p - step), nearness_at(p + 2 * step), nearness_at(p + 4 * step));
        is_apart = depth_apart(nearnesses) >= APART;
        found.y = max(found.y, select(0.0, 1.0, is_apart));
    }
    if (params.guides & 4u) != 0u {
        let differs = known_id(fetch(object_id, 2u, p).x) != known_id(fetch(object_id, 2u, p + step).x);
        if differs {
            // What touches what is known by depth.
            let touches = (params.guides & 2u) != 0u && !is_apart;
            found = vec3f(0.0, select(1.0, found.y, touches), select(0.0, 1.0, touches));
        }
    }
    return found;
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = pixel(id);
    let across = max(breaks(p, vec2i(1, 0)), breaks(p, vec2i(-1, 0)));
    let down = max(breaks(p, vec2i(0, 1)), breaks(p, vec2i(0, -1)));
    textureStore(target_image, vec2i(id.xy), vec4f(max(across, down), 0.0));
}
