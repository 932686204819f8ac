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

fn covered_between(image: texture_2d<f32>, slot: u32, p: vec2i, next: vec2i, share: f32) -> vec4f {
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
    let corner = floor(p - 0.5);
    let f = p - 0.5 - corner;
    let i = vec2i(corner);
    let a = fetch_covered(image, slot, i);
    let b = fetch_covered(image, slot, i + vec2i(1, 0));
    let c = fetch_covered(image, slot, i + vec2i(0, 1));
    let d = fetch_covered(image, slot, i + vec2i(1, 1));
    let top = a + (b - a) * f.x;
    let bottom = c + (d - c) * f.x;
    return top + (bottom - top) * f.y;
}
