// How far a guide of a neighbouring frame agrees with that of the frame at hand.
// Cost: five loads and 30 operations.
#import shared/motion

struct Params {
    /// 0: depth, compared by its share; 1: object numbers, alike or not.
    kind: i32,
    /// 1 where the third input is a weight to begin with, 0 where it is anything.
    weighted: f32,
}

#params
#input own, motion, weights, theirs
#output target_image r32float

// Agreement of two values of a guide, 0..1.
fn agreement(here: f32, there: f32) -> f32 {
    if params.kind == 1 {
        return select(0.0, 1.0, here == there);
    }
    let nothing = here <= 0.0;
    let far = abs(here - there) / max(here, 1e-20);
    return select(clamp(2.0 - 20.0 * far, 0.0, 1.0), 1.0, nothing && there <= 0.0);
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let step = fetch(motion, 1u, pixel(id)).xy;
    let place = centre(id) + select(vec2f(0.0), step, is_known(step));
    let here = fetch(own, 0u, pixel(id)).x;
    let last = vec2f(grid.inputs[3].zw);
    let i = vec2i(floor(min(max(place - 0.5, vec2f(-2.0)), last + 2.0)));
    // Guides are not smoothed at borders: one of the four around is enough.
    var best = agreement(here, fetch(theirs, 3u, i).x);
    best = max(best, agreement(here, fetch(theirs, 3u, i + vec2i(1, 0)).x));
    best = max(best, agreement(here, fetch(theirs, 3u, i + vec2i(0, 1)).x));
    best = max(best, agreement(here, fetch(theirs, 3u, i + vec2i(1, 1)).x));
    let weight = select(1.0, fetch(weights, 2u, pixel(id)).x, params.weighted > 0.0);
    textureStore(target_image, vec2i(id.xy), vec4f(best * weight, 0.0, 0.0, 0.0));
}
