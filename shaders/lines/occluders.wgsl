// Nearness of what stands in front, at pixels just behind where depth jumps: (1/z, 1/z, 1/z, 1) of the nearest such thing,
// and (0, 0, 0, 1) elsewhere.
// Cost: nine loads and about 60 operations.
#import gpu/grid
#import shared/breaks

#input depth
#output target_image rgba32float

fn nearness_at(p: vec2i) -> f32 {
    return nearness(known_depth(fetch(depth, 0u, p).x));
}

// Nearness of what is in front of a pixel within three steps from it, 0 where nothing is.
fn in_front(p: vec2i, step: vec2i) -> f32 {
    let nearnesses = vec4f(nearness_at(p - 2 * step), nearness_at(p), nearness_at(p + 3 * step), nearness_at(p + 5 * step));
    let is_in_front = depth_apart(nearnesses) >= APART && nearnesses.z > nearnesses.y;
    return select(0.0, nearnesses.z, is_in_front);
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = pixel(id);
    let across = max(in_front(p, vec2i(1, 0)), in_front(p, vec2i(-1, 0)));
    let down = max(in_front(p, vec2i(0, 1)), in_front(p, vec2i(0, -1)));
    textureStore(target_image, vec2i(id.xy), vec4f(vec3f(max(across, down)), 1.0));
}
