// Motion over several frames: what was found so far, and the next step at the place that it leads to.
// Cost: five loads.
#import shared/motion

struct Params {
    /// Longest step that counts, pixels.
    step: f32,
    /// Longest motion over all frames that counts, pixels.
    limit: f32,
}

#params
#input so_far, steps
#output target_image rg32float

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let found = fetch(so_far, 0u, pixel(id)).xy;
    let place = centre(id) + select(vec2f(0.0), found, is_known(found));
    let full = grid.inputs[1].zw;
    let second = motion_at(steps, 1u, place, params.step);
    let whole = bounded_motion(found + second, params.limit);
    let known = is_known(found) && is_known(second) && is_inside(place, full);
    textureStore(target_image, vec2i(id.xy), vec4f(select(vec2f(UNKNOWN_MOTION), whole, known), 0.0, 0.0));
}
