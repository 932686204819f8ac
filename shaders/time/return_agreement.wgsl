// How far motion to a neighbouring frame and from there back lead to where they started.
// Cost: six loads and 40 operations.
#import shared/motion

struct Params {
    /// Longest motion back that counts, pixels.
    limit: f32,
    /// 1 where the third input is a weight to begin with, 0 where it is anything.
    weighted: f32,
}

#params
#input motion, weights, back
#output target_image r32float

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let step = fetch(motion, 0u, pixel(id)).xy;
    let place = centre(id) + select(vec2f(0.0), step, is_known(step));
    let last = vec2f(grid.inputs[2].zw);
    let i = vec2i(floor(min(max(place - 0.5, vec2f(-2.0)), last + 2.0)));
    // As with guides, one of the four around is enough.
    var least = 1e18;
    for (var n = 0; n < 4; n++) {
        let home = bounded_motion(fetch(back, 2u, i + vec2i(n & 1, n >> 1)).xy, params.limit);
        let missed = step + home;
        least = min(least, select(1e18, dot(missed, missed), is_known(home)));
    }
    // Long motions are less exact.
    let slack = 1.0 + 0.01 * dot(step, step);
    let agreement = clamp(2.0 - least / slack, 0.0, 1.0);
    let weight = select(1.0, fetch(weights, 1u, pixel(id)).x, params.weighted > 0.0);
    textureStore(target_image, vec2i(id.xy), vec4f(agreement * weight, 0.0, 0.0, 0.0));
}
