// Functions of shared/coverage for devices that filter: a sampler interpolates where everything is opaque, as nearly all
// of nearly every picture is. Its weights have eight bits of fraction on common hardware, which is enough for colours.
// Where something is transparent, colours must be multiplied by their alpha before they are interpolated.

@group(0) @binding(15) var filtering: sampler;

// `image` interpolated at absolute position p of input `slot`, clamped to the picture's edge. The texture may be larger than
// the picture.
fn sample_filtered(image: texture_2d<f32>, slot: u32, p: vec2f) -> vec4f {
    let place = grid.inputs[slot];
    let texel = clamp(p, vec2f(0.5), vec2f(place.zw) - 0.5) - vec2f(place.xy);
    return textureSampleLevel(image, filtering, texel / vec2f(textureDimensions(image)), 0.0);
}

fn covered_between(image: texture_2d<f32>, slot: u32, p: vec2i, next: vec2i, share: f32, inside: bool) -> vec4f {
    let v = sample_filtered(image, slot, vec2f(p) + 0.5 + share * vec2f(next));
    if v.a == 1.0 {
        return v;
    }
    let a = fetch_covered(image, slot, p);
    let b = fetch_covered(image, slot, p + next);
    return a + (b - a) * share;
}

fn sample_covered(image: texture_2d<f32>, slot: u32, p: vec2f) -> vec4f {
    let v = sample_filtered(image, slot, p);
    if v.a == 1.0 {
        return v;
    }
    let s = surroundings(slot, p);
    let a = premultiply(textureLoad(image, s.near, 0));
    let b = premultiply(textureLoad(image, vec2i(s.far.x, s.near.y), 0));
    let c = premultiply(textureLoad(image, vec2i(s.near.x, s.far.y), 0));
    let d = premultiply(textureLoad(image, s.far, 0));
    return bilinear(a, b, c, d, s.f);
}
