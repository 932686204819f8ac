// Functions of shared/coverage for devices that filter: a sampler interpolates where everything is opaque, as nearly all
// of nearly every picture is. Its weights have eight bits of fraction on common hardware, which is enough for colours.
// Where something is transparent, colours must be multiplied by their alpha before they are interpolated.

@group(0) @binding(15) var filtering: sampler;

// What a texel is in coordinates of the sampler. To ask for the texture's size at every tap takes two divisions each time.
var<private> texel_size: vec2f;

fn covered_begin(image: texture_2d<f32>) {
    texel_size = 1.0 / vec2f(textureDimensions(image));
}

fn multiplied_between(
    image: texture_2d<f32>,
    slot: u32,
    p: vec2i,
    texel: vec2i,
    next: vec2i,
    share: f32,
    inside: bool,
) -> vec4f {
    var at = vec2f(texel) + share * vec2f(next);
    if !inside {
        // Samplers clamp to the texture, which may be larger than the picture.
        at = min(at, vec2f(grid.inputs[slot].zw - 1 - grid.inputs[slot].xy));
    }
    return textureSampleLevel(image, filtering, (at + 0.5) * texel_size, 0.0);
}

fn covered_between(
    image: texture_2d<f32>,
    slot: u32,
    p: vec2i,
    texel: vec2i,
    next: vec2i,
    share: f32,
    inside: bool,
) -> vec4f {
    let v = multiplied_between(image, slot, p, texel, next, share, inside);
    if v.a == 1.0 {
        return v;
    }
    let a = fetch_covered(image, slot, p);
    let b = fetch_covered(image, slot, p + next);
    return a + (b - a) * share;
}

fn sample_multiplied_among(image: texture_2d<f32>, s: Surroundings) -> vec4f {
    let at = vec2f(s.near) + s.f + 0.5;
    return textureSampleLevel(image, filtering, at * texel_size, 0.0);
}

fn sample_covered_among(image: texture_2d<f32>, s: Surroundings) -> vec4f {
    let v = sample_multiplied_among(image, s);
    if v.a == 1.0 {
        return v;
    }
    let a = premultiply(textureLoad(image, s.near, 0));
    let b = premultiply(textureLoad(image, vec2i(s.far.x, s.near.y), 0));
    let c = premultiply(textureLoad(image, vec2i(s.near.x, s.far.y), 0));
    let d = premultiply(textureLoad(image, s.far, 0));
    return bilinear(a, b, c, d, s.f);
}

fn sample_covered(image: texture_2d<f32>, slot: u32, p: vec2f) -> vec4f {
    return sample_covered_among(image, surroundings(slot, p));
}
