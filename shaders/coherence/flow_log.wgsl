// The flow-based Laplacian of Gaussian (Listing 6.1): the scale-normalised second derivative of a
// Gaussian of the luma, along the major eigenvector. Negative about maxima, positive about minima.
// Cost: per step four loads and about 25 multiply-adds.
#import grid
#import tensor

struct Params {
    // Standard deviation, pixels.
    sigma: f32,
    // Distance of the last tap, pixels.
    reach: f32,
}

@group(0) @binding(1) var<uniform> params: Params;
@group(0) @binding(2) var source: texture_2d<f32>;
@group(0) @binding(3) var tensors: texture_2d<f32>;
@group(0) @binding(4) var target_image: texture_storage_2d<r32float, write>;

// Luma times coverage, and coverage.
fn tap(p: vec2i) -> vec2f {
    let v = fetch(source, 0u, p);
    return vec2f(dot(v.rgb, vec3f(0.2126, 0.7152, 0.0722)) * v.a, v.a);
}

// By how much the luma `along` pixels on, `across` pixels to the side, exceeds that of the centre;
// transparent taps stand for the centre.
fn difference(p: vec2i, along_x: bool, along: i32, across: f32, centre: f32) -> f32 {
    let i = floor(across);
    let q = p + select(vec2i(i32(i), along), vec2i(along, i32(i)), along_x);
    let a = tap(q);
    let b = tap(q + select(vec2i(1, 0), vec2i(0, 1), along_x));
    let v = a + (b - a) * (across - i);
    return v.x - v.y * centre;
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = pixel(id);
    let tensor = fetch(tensors, 1u, p);
    let n = tensor_axis((tensor.x - tensor.z) * 0.5, tensor.y).major;
    // Steps of one pixel along the axis nearer to n (Fig. 3.9).
    let along_x = abs(n.x) > abs(n.y);
    let major = select(n.y, n.x, along_x);
    let slope = select(n.x, n.y, along_x) / major;
    let step = 1.0 / abs(major);
    let steps = i32((params.reach + 1e-3) * abs(major));

    let color = fetch(source, 0u, p);
    let centre = dot(color.rgb, vec3f(0.2126, 0.7152, 0.0722));
    let variance = params.sigma * params.sigma;
    // exp(-d^2 / 2 sigma^2) at d = k step, from one step to the next.
    let falloff = exp2(-0.72134752 * step * step / variance);
    var gaussian = falloff;
    var ratio = falloff * falloff * falloff;
    var sum = 0.0;
    for (var k = 1; k <= steps; k++) {
        let d = f32(k) * step;
        let across = f32(k) * slope;
        let both = difference(p, along_x, k, across, centre) + difference(p, along_x, -k, -across, centre);
        sum += (d * d - variance) * gaussian * both;
        gaussian *= ratio;
        ratio *= falloff * falloff;
    }
    // Weights sum to zero by taking differences to the centre, so flat parts respond with exactly 0.
    let response = sum * step / (2.5066283 * variance * params.sigma);
    textureStore(target_image, vec2i(id.xy), vec4f(response, 0.0, 0.0, 0.0));
}
