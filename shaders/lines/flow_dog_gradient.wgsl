// First pass of the separable flow-based difference of Gaussians (Listing 4.1): a one-dimensional
// difference of Gaussians across the tangent, on lightness and coverage (L alpha, alpha).
//
// Steps have length 1 along the axis nearer to the gradient, so a sample lies between two pixels of
// one row or column, and two loads interpolate it exactly as a bilinear sample would.
// Cost: 4 loads and two exponentials per step, about 3 k sigma_e steps.
#import gpu/grid
#import shared/tensor
#import shared/edge_threshold

struct Params {
    /// -1 / (2 sigma^2) of the narrower Gaussian.
    narrow: f32,
    /// The same of the wider Gaussian.
    wide: f32,
    /// Cut-off, in pixels.
    halfwidth: f32,
    /// Weight of the smoothed lightness.
    base: f32,
    /// Weight of the difference of Gaussians.
    edge: f32,
}

@group(0) @binding(1) var<uniform> params: Params;
@group(0) @binding(2) var lightness: texture_2d<f32>;
// (E - G, F), see orientation_field.
@group(0) @binding(3) var field: texture_2d<f32>;
@group(0) @binding(4) var target_image: texture_storage_2d<rg32float, write>;

// Sample k steps along the main axis and k * slope across it.
fn sample(p: vec2i, upright: bool, k: i32, slope: f32) -> vec2f {
    let across = f32(k) * slope;
    let whole = floor(across);
    let f = across - whole;
    let i = i32(whole);
    let o = select(vec2i(k, i), vec2i(i, k), upright);
    let next = select(vec2i(0, 1), vec2i(1, 0), upright);
    let a = fetch(lightness, 0u, p + o).xy;
    let b = fetch(lightness, 0u, p + o + next).xy;
    return a + (b - a) * f;
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = pixel(id);
    let t = tensor_tangent(fetch(field, 1u, p));
    // The gradient is (t.y, -t.x); its sign means nothing.
    let upright = abs(t.x) > abs(t.y);
    let slope = select(-t.x / t.y, -t.y / t.x, upright);
    let ds = sqrt(1.0 + slope * slope);

    let middle = fetch(lightness, 0u, p).xy;
    var narrow = middle;
    var wide = middle;
    for (var k = 1; f32(k) * ds <= params.halfwidth; k++) {
        let d = f32(k) * ds;
        let both = sample(p, upright, k, slope) + sample(p, upright, -k, slope);
        narrow += exp(params.narrow * d * d) * both;
        wide += exp(params.wide * d * d) * both;
    }
    let u = dog_of_sums(narrow, wide, params.base, params.edge);
    textureStore(target_image, vec2i(id.xy), vec4f(u * middle.y, middle.y, 0.0, 0.0));
}
