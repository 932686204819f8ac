// Bristle marks and shine of paint on a Lab image, from a field of heights that follows the strokes.
// Cost: six loads and 25 multiply-adds.
#import gpu/grid

struct Params {
    /// Direction from where the light comes, times the strength of the shine per unit of slope.
    light: vec2f,
    /// Lightness per unit of height.
    bristle: f32,
}

#params
#input source, heights
#output target_image rgba32float

fn height(p: vec2i) -> f32 {
    return fetch(heights, 1u, p).x;
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = pixel(id);
    let v = fetch(source, 0u, p);
    // Slopes that fall towards the light are lit.
    let dx = 0.5 * (height(p + vec2i(1, 0)) - height(p - vec2i(1, 0)));
    let dy = 0.5 * (height(p + vec2i(0, 1)) - height(p - vec2i(0, 1)));
    let lift = params.bristle * (height(p) - 0.5) - (params.light.x * dx + params.light.y * dy);
    // In proportion to the root of luminance: little shows on black, and highlights keep theirs.
    let share = (max(v.x, 0.0) + 16.0) / 116.0;
    textureStore(target_image, vec2i(id.xy), vec4f(v.x + share * lift, v.yzw));
}
