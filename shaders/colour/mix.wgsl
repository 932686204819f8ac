// Blend of two pictures, by coverage.
// Cost: two loads and eight multiply-adds.
#import shared/coverage

struct Params {
    /// Share of the second picture, 0..=1.
    amount: f32,
}

#params
#input first, second
#output target_image rgba32float

fn of_pixel(id: vec3u, a: vec4f, b: vec4f) -> vec4f {
    let weights = vec2f((1.0 - params.amount) * a.a, params.amount * b.a);
    let mixed = vec4f(weights.x * a.rgb + weights.y * b.rgb, weights.x + weights.y);
    return unpremultiply(mixed);
}
