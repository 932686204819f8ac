// Magnitude of the gradient of the luma by the Sobel operator (2.23), in the first channel.
// Cost: nine loads.
#import gpu/grid

#input source
#output target_image rgba32float

fn luma(v: vec4f) -> f32 {
    return dot(v.rgb, vec3f(0.2126, 0.7152, 0.0722));
}

// By how much a neighbour exceeds the centre; where it is transparent it stands for the centre.
fn excess(p: vec2i, centre: f32) -> f32 {
    let v = fetch(source, 0u, p);
    return (luma(v) - centre) * v.a;
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = pixel(id);
    let color = fetch(source, 0u, p);
    let c = luma(color);
    let left_up = excess(p + vec2i(-1, -1), c);
    let left_down = excess(p + vec2i(-1, 1), c);
    let right_up = excess(p + vec2i(1, -1), c);
    let right_down = excess(p + vec2i(1, 1), c);
    let x = 0.5 * (excess(p + vec2i(1, 0), c) - excess(p - vec2i(1, 0), c))
        + 0.25 * ((right_up - left_up) + (right_down - left_down));
    let y = 0.5 * (excess(p + vec2i(0, 1), c) - excess(p - vec2i(0, 1), c))
        + 0.25 * ((left_down - left_up) + (right_down - right_up));
    let magnitude = 0.5 * sqrt(x * x + y * y) * color.a;
    textureStore(target_image, vec2i(id.xy), vec4f(magnitude, 0.0, 0.0, 1.0));
}
