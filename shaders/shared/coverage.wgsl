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

// Between the pixel at absolute position p and that at p + next, so much of the way, colours multiplied by their alpha.
fn covered_between(image: texture_2d<f32>, slot: u32, p: vec2i, next: vec2i, share: f32) -> vec4f {
    let a = fetch_covered(image, slot, p);
    let b = fetch_covered(image, slot, p + next);
    return a + (b - a) * share;
}

// `sample_linear` of colours multiplied by their alpha.
fn sample_covered(image: texture_2d<f32>, slot: u32, p: vec2f) -> vec4f {
    let last = vec2f(grid.inputs[slot].zw);
    let q = min(max(p - 0.5, vec2f(-2.0)), last + 2.0);
    let corner = floor(q);
    let f = q - corner;
    let i = vec2i(corner);
    let a = fetch_covered(image, slot, i);
    let b = fetch_covered(image, slot, i + vec2i(1, 0));
    let c = fetch_covered(image, slot, i + vec2i(0, 1));
    let d = fetch_covered(image, slot, i + vec2i(1, 1));
    let top = a + (b - a) * f.x;
    let bottom = c + (d - c) * f.x;
    return top + (bottom - top) * f.y;
}

// Mean coverage, exactly 1 where only rounding can have kept it from that.
fn full_or(coverage: f32) -> f32 {
    return select(coverage, 1.0, coverage > 0.999998);
}
