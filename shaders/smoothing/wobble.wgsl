// Moves every pixel a little, by smooth noise, so that outlines waver as a hand's do. The noise belongs
// to the full-size picture.
// Cost: 16 hashes, one bilinear sample and about 150 multiply-adds.
#import shared/value_noise
#import shared/coverage

struct Params {
    /// Pixels of the full-size picture per pixel.
    inverse_scale: f32,
    /// Farthest that a pixel is fetched from on each axis, pixels.
    amount: f32,
    /// Waves per pixel of the full-size picture.
    frequency: f32,
    /// Where the picture stands in the canonical one, pixels.
    origin: vec2f,
}

#params
#input source
#output target_image rgba32float

fn offset(q: vec2f, seed: u32) -> f32 {
    return params.amount * (1.3 * value_noise(q, seed) + 0.7 * value_noise(q * 2.7, seed + 97u) - 1.0);
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    covered_begin(source);
    let q = (centre(id) + params.origin) * params.inverse_scale * params.frequency;
    let place = centre(id) + vec2f(offset(q, 3001u), offset(q, 5003u));
    let v = sample_covered(source, 0u, place);
    textureStore(target_image, vec2i(id.xy), unpremultiply(v));
}
