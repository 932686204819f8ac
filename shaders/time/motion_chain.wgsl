// Motion over several frames: what was found so far, and the next step at the place that it leads to.
// Cost: five loads.
#import shared/motion

struct Params {
    /// Longest step that counts, pixels.
    step: f32,
    /// Longest motion over all frames that counts, pixels.
    limit: f32,
}

@group(0) @binding(1) var<uniform> params: Params;
@group(0) @binding(2) var so_far: texture_2d<f32>;
@group(0) @binding(3) var steps: texture_2d<f32>;
@group(0) @binding(4) var target_image: texture_storage_2d<rg32float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let found = fetch(so_far, 0u, pixel(id)).xy;
    let place = centre(id) + select(vec2f(0.0), found, is_known(found));
    let full = grid.inputs[1].zw;
    let q = min(max(place - 0.5, vec2f(-2.0)), vec2f(full) + 2.0);
    let corner = floor(q);
    let f = q - corner;
    let i = vec2i(corner);
    let a = bounded_motion(fetch(steps, 1u, i).xy, params.step);
    let b = bounded_motion(fetch(steps, 1u, i + vec2i(1, 0)).xy, params.step);
    let c = bounded_motion(fetch(steps, 1u, i + vec2i(0, 1)).xy, params.step);
    let d = bounded_motion(fetch(steps, 1u, i + vec2i(1, 1)).xy, params.step);
    let top = a + (b - a) * f.x;
    let bottom = c + (d - c) * f.x;
    let mean = top + (bottom - top) * f.y;
    // Across the border of a thing the motions on both sides have no mean: the nearest one holds.
    let spread = max(max(a, b), max(c, d)) - min(min(a, b), min(c, d));
    let near = bounded_motion(fetch(steps, 1u, vec2i(floor(place))).xy, params.step);
    let second = select(near, mean, max(spread.x, spread.y) <= 1.0);
    let whole = bounded_motion(found + second, params.limit);
    let known = is_known(found) && is_known(second) && is_inside(place, full);
    textureStore(target_image, vec2i(id.xy), vec4f(select(vec2f(UNKNOWN_MOTION), whole, known), 0.0, 0.0));
}
