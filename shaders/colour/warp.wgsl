// Moves every pixel's sample against the gradient of a field, the first channel of an image.
// Cost: four loads of the field and four of the colour.
#import shared/coverage

struct Params {
    /// Pixels moved per unit of the gradient.
    amount: f32,
    /// Largest move, pixels.
    limit: f32,
}

#params
#input source, field
#output target_image rgba32float

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    covered_begin(source);
    let p = pixel(id);
    let x = fetch(field, 1u, p + vec2i(1, 0)).x - fetch(field, 1u, p - vec2i(1, 0)).x;
    let y = fetch(field, 1u, p + vec2i(0, 1)).x - fetch(field, 1u, p - vec2i(0, 1)).x;
    let move_by = -0.5 * params.amount * vec2f(x, y);
    let length = sqrt(dot(move_by, move_by));
    let bounded = move_by * (params.limit / max(length, max(params.limit, 1e-6)));
    let sum = sample_covered(source, 0u, centre(id) + bounded);
    textureStore(target_image, vec2i(id.xy), unpremultiply(sum));
}
