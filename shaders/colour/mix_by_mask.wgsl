// Blend of two pictures, by coverage and by a mask.
// Cost: three loads and ten multiply-adds.
#import shared/coverage
#import shared/host_colour

struct Params {
    /// Share of the second picture where the mask is 1, 0..=1.
    amount: f32,
}

#params
#input first, second, mask
#output target_image rgba32float

fn of_pixel(id: vec3u, a: vec4f, b: vec4f, mask: vec4f) -> vec4f {
    // As coverage comes in: cut to 0..=1, and 0 for what is not a number.
    let amount = params.amount * finite(vec4f(0.0, 0.0, 0.0, mask.x)).a;
    let weights = vec2f((1.0 - amount) * a.a, amount * b.a);
    let mixed = unpremultiply(vec4f(weights.x * a.rgb + weights.y * b.rgb, weights.x + weights.y));
    // Where only one counts it passes to the bit.
    let one = select(mixed, a, amount == 0.0);
    return select(one, b, amount == 1.0);
}
