#import shared/sampling

// Colours that are to be mixed count by their coverage, so that transparent pixels lend no colour.
// Twin of kernels/shared/coverage.rs.

// Coverage up to which a pixel counts as empty.
const LEAST_COVERAGE: f32 = 1e-6;

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

// Between the pixel at absolute position p and that at p + next, `share` of the way, colours multiplied by their alpha; of
// pixels that are not `inside`, clamped to the picture.
fn covered_between(image: texture_2d<f32>, slot: u32, p: vec2i, next: vec2i, share: f32, inside: bool) -> vec4f {
    var a: vec4f;
    var b: vec4f;
    if inside {
        let texel = p - grid.inputs[slot].xy;
        a = premultiply(textureLoad(image, texel, 0));
        b = premultiply(textureLoad(image, texel + next, 0));
    } else {
        a = fetch_covered(image, slot, p);
        b = fetch_covered(image, slot, p + next);
    }
    return a + (b - a) * share;
}

// `sample_linear` of colours multiplied by their alpha.
fn sample_covered(image: texture_2d<f32>, slot: u32, p: vec2f) -> vec4f {
    let s = surroundings(slot, p);
    let a = premultiply(textureLoad(image, s.near, 0));
    let b = premultiply(textureLoad(image, vec2i(s.far.x, s.near.y), 0));
    let c = premultiply(textureLoad(image, vec2i(s.near.x, s.far.y), 0));
    let d = premultiply(textureLoad(image, s.far, 0));
    return bilinear(a, b, c, d, s.f);
}

// Mean coverage, exactly 1 where only rounding can have kept it from that.
fn full_or(coverage: f32) -> f32 {
    return select(coverage, 1.0, coverage > 0.999998);
}
