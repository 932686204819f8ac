// From where a pixel is to where its point was when each of two layers of marks was anchored, frame by frame: what was
// found so far, and the next step where that leads to.
// Cost: eleven loads and about 60 operations.
#import shared/motion

struct Params {
    /// Longest step that counts, pixels.
    step: f32,
    /// Farthest on each axis that marks are carried, pixels.
    limit: f32,
    /// Nonzero for layers that were anchored before the frame that this step leads from.
    advance: vec2u,
    /// Nonzero for the first step, before which nothing was found.
    begin: u32,
}

#params
#input so_far, steps
#output target_image rgba32float

// One step on; a point whose motion is not known, or that goes too far, stays where it is for this frame.
fn onward(found: vec2f, here: vec2f, advance: u32) -> vec2f {
    let step = motion_at(steps, 1u, here + found, params.step);
    let whole = found + step;
    let goes = advance != 0u && is_known(step) && all(abs(whole) <= vec2f(params.limit));
    return select(found, whole, goes);
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let found = select(fetch(so_far, 0u, pixel(id)), vec4f(0.0), params.begin != 0u);
    let first = onward(found.xy, centre(id), params.advance.x);
    let second = onward(found.zw, centre(id), params.advance.y);
    textureStore(target_image, vec2i(id.xy), vec4f(first, second));
}
