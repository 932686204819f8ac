// Smooth noise of the screen, of two layers: clouds of pigment. Cells are those of the full-size picture. Grey and
// opaque.
// Cost: eight hashes and about 60 multiply-adds.
#import shared/value_noise
#import gpu/grid

struct Params {
    /// Cells of each layer per pixel of the full-size picture.
    frequencies: vec2f,
    /// Share of each layer.
    shares: vec2f,
    /// Another number gives another noise.
    seeds: vec2u,
    /// Where the picture stands in the canonical one, pixels.
    origin: vec2f,
    /// Pixels of the full-size picture per pixel.
    inverse_scale: f32,
}

#params
#output target_image rgba32float

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let q = (centre(id) + params.origin) * params.inverse_scale;
    let first = value_noise(q * params.frequencies.x, params.seeds.x);
    let second = value_noise(q * params.frequencies.y, params.seeds.y);
    let value = params.shares.x * first + params.shares.y * second;
    textureStore(target_image, vec2i(id.xy), vec4f(vec3f(value), 1.0));
}
