#import shared/sampling

// Colours that are to be mixed count by their coverage, so that transparent pixels lend no colour.
// Twin of kernels/shared/coverage.rs.

// Coverage up to which a pixel counts as empty.
const LEAST_COVERAGE: f32 = 1e-6;

// Comes before all interpolation: `image` is what is interpolated. Shaders interpolate one image.
fn covered_begin(image: texture_2d<f32>) {
}

// A colour times its alpha.
fn premultiply(v: vec4f) -> vec4f {
    return vec4f(v.rgb * v.a, v.a);
}

// A colour without the alpha that it is multiplied by; black where nothing is covered.
fn unpremultiply(v: vec4f) -> vec4f {
    return vec4f(select(vec3f(0.0), v.rgb / v.a, v.a > LEAST_COVERAGE), v.a);
}

// The pixel at absolute position p of input `slot`, its colour multiplied by its alpha.
fn fetch_covered(image: texture_2d<f32>, slot: u32, p: vec2i) -> vec4f {
    return premultiply(fetch(image, slot, p));
}

// Between two pixels, `share` of the way from that at absolute position p to that at p + next, colours multiplied by their
// alpha; where both lie `inside` the picture, by the first one's texel.
fn covered_between(
    image: texture_2d<f32>,
    slot: u32,
    p: vec2i,
    texel: vec2i,
    next: vec2i,
    share: f32,
    inside: bool,
) -> vec4f {
    var a: vec4f;
    var b: vec4f;
    if inside {
        a = premultiply(textureLoad(image, texel, 0));
        b = premultiply(textureLoad(image, texel + next, 0));
    } else {
        a = fetch_covered(image, slot, p);
        b = fetch_covered(image, slot, p + next);
    }
    return a + (b - a) * share;
}

// `sample_among` of colours multiplied by their alpha.
fn sample_covered_among(image: texture_2d<f32>, s: Surroundings) -> vec4f {
    let a = premultiply(textureLoad(image, s.near, 0));
    let b = premultiply(textureLoad(image, vec2i(s.far.x, s.near.y), 0));
    let c = premultiply(textureLoad(image, vec2i(s.near.x, s.far.y), 0));
    let d = premultiply(textureLoad(image, s.far, 0));
    return bilinear(a, b, c, d, s.f);
}

// `sample_among` of values that are multiplied by their coverage already, such as (L alpha, alpha).
fn sample_multiplied_among(image: texture_2d<f32>, s: Surroundings) -> vec4f {
    return sample_among(image, s);
}

// Such values between two pixels, as `covered_between`.
fn multiplied_between(
    image: texture_2d<f32>,
    slot: u32,
    p: vec2i,
    texel: vec2i,
    next: vec2i,
    share: f32,
    inside: bool,
) -> vec4f {
    var a: vec4f;
    var b: vec4f;
    if inside {
        a = textureLoad(image, texel, 0);
        b = textureLoad(image, texel + next, 0);
    } else {
        a = fetch(image, slot, p);
        b = fetch(image, slot, p + next);
    }
    return a + (b - a) * share;
}

// `sample_linear` of colours multiplied by their alpha.
fn sample_covered(image: texture_2d<f32>, slot: u32, p: vec2f) -> vec4f {
    return sample_covered_among(image, surroundings(slot, p));
}

// Mean coverage, exactly 1 where only rounding can have kept it from that.
fn full_or(coverage: f32) -> f32 {
    return select(coverage, 1.0, coverage > 0.999998);
}
