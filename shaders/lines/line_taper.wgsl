// Lines that run out into a point: narrower towards their ends, where a line goes on to one side alone.
// Cost: 32 loads and about 200 operations.
#import gpu/grid
#import shared/tensor

struct Params {
    /// -1 / (2 sigma^2) of the Gaussian along lines, by steps.
    falloff: f32,
    /// Steps between samples.
    stride: i32,
    /// Samples on each side.
    samples: i32,
}

#params
// 1 = paper, 0 = line.
#input edges
// In the first channel: the same smoothed in all directions, and the least of that around.
#input soft, darkest
// (E - G, F), see orientation_field.
#input field
#output target_image r32float

// Share of a line below which nothing is known of it.
const LEAST_SHARE: f32 = 0.05;
// Share of a line's own density below which it goes on to no side.
const LEAST_SIDE: f32 = 0.35;

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = pixel(id);
    let orientation = fetch(field, 3u, p);
    // Across what is across: along the line.
    let t = tensor_tangent(vec4f(-orientation.xy, 0.0, 0.0));
    let upright = abs(t.x) > abs(t.y);
    let slope = select(-t.x / t.y, -t.y / t.x, upright);
    let ds = 1.0 + slope * slope;
    var sides = vec2f(0.0);
    var weights = 0.0;
    for (var i = 1; i <= params.samples; i++) {
        let k = i * params.stride;
        // Ties are decided off the middle, so that rounding does not.
        let ahead = i32(floor(f32(k) * slope + 0.502));
        let back = i32(floor(f32(-k) * slope + 0.502));
        let w = exp(params.falloff * ds * f32(k) * f32(k));
        let a = fetch(soft, 1u, p + select(vec2i(k, ahead), vec2i(ahead, k), upright)).x;
        let b = fetch(soft, 1u, p + select(vec2i(-k, back), vec2i(back, -k), upright)).x;
        sides += w * (1.0 - vec2f(a, b));
        weights += w;
    }
    sides /= weights;
    let own = 1.0 - fetch(soft, 1u, p).x;
    let most = max(max(sides.x, sides.y), LEAST_SIDE * own);
    let inside = clamp(1.6 * min(sides.x, sides.y) / max(most, LEAST_SHARE), 0.0, 1.0);
    // 1 on the middle of the line, and about two thirds at its borders.
    let height = own / max(1.0 - fetch(darkest, 2u, p).x, LEAST_SHARE);
    let narrow = clamp((height - mix(1.02, 0.6, inside)) * 12.0, 0.0, 1.0);
    let kept = mix(narrow, 1.0, clamp((inside - 0.8) * 5.0, 0.0, 1.0));
    let line = 1.0 - clamp(fetch(edges, 0u, p).x, 0.0, 1.0);
    textureStore(target_image, vec2i(id.xy), vec4f(1.0 - line * kept, 0.0, 0.0, 0.0));
}
