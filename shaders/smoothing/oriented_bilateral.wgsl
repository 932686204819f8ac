// One pass of the orientation-aligned bilateral filter (Listing 3.1), along the gradient or along the
// tangent; the range is measured as Euclidean distance of the three colour channels.
// Cost: about 2 cutoff taps of two loads, one interpolation and one or two exponentials.
#import shared/coverage
#import shared/tensor

struct Params {
    /// Standard deviation along the line, pixels.
    sigma_d: f32,
    /// Standard deviation of the range, in the unit of the colour.
    sigma_r: f32,
    /// Distance of the last tap, pixels.
    cutoff: f32,
    /// Growth of the tangent's scale, and shrinking of the gradient's, per unit of anisotropy.
    elongation: f32,
    /// 1: along the tangent; 0: along the gradient.
    tangential: u32,
    /// Range weights, 0: after the interpolation; 1: before it (3.9); 2: of the nearest pixel.
    sampling: u32,
}

@group(0) @binding(1) var<uniform> params: Params;
@group(0) @binding(2) var source: texture_2d<f32>;
@group(0) @binding(3) var tensors: texture_2d<f32>;
@group(0) @binding(4) var target_image: texture_storage_2d<rgba32float, write>;

const SAMPLING_LINEAR = 0u;
const SAMPLING_NEAREST = 2u;

fn weight(color: vec3f, origin: vec3f, domain: f32, range: f32) -> f32 {
    let d = color - origin;
    return exp2(range * dot(d, d) + domain);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = pixel(id);
    let tensor = fetch(tensors, 1u, p);
    let tangent = tensor_tangent(tensor);
    let stretch = 1.0 + params.elongation * tensor_anisotropy(tensor);
    let t = select(vec2f(tangent.y, -tangent.x), tangent, params.tangential != 0u);
    let scale = select(1.0 / stretch, stretch, params.tangential != 0u);

    // Steps of one pixel along the axis nearer to t: taps then lie between two pixels (3.6, 3.7).
    let along_x = abs(t.x) > abs(t.y);
    let major = select(t.y, t.x, along_x);
    let slope = select(t.x, t.y, along_x) / major;
    let steps = i32((params.cutoff * scale + 1e-3) * abs(major));
    let next = select(vec2i(1, 0), vec2i(0, 1), along_x);

    // Both Gaussians as powers of two.
    let sigma_d = params.sigma_d * scale * abs(major);
    let domain = -0.72134752 / max(sigma_d * sigma_d, 1e-6);
    let range = -0.72134752 / max(params.sigma_r * params.sigma_r, 1e-6);

    let origin = fetch(source, 0u, p);
    var sum = vec4f(origin.rgb * origin.a, origin.a);
    for (var k = 1; k <= steps; k++) {
        let distance = f32(k);
        for (var side = -1; side <= 1; side += 2) {
            let o = f32(side) * distance * slope;
            let i = floor(o);
            let f = o - i;
            let q = p + select(vec2i(i32(i), side * k), vec2i(side * k, i32(i)), along_x);
            if params.sampling != SAMPLING_LINEAR {
                let a = fetch(source, 0u, q);
                let b = fetch(source, 0u, q + next);
                let near = params.sampling == SAMPLING_NEAREST;
                let share = select(vec2f(1.0 - f, f), vec2f(vec2(1.0 - f, f) >= vec2f(0.5)), near);
                let wa = share.x * a.a * weight(a.rgb, origin.rgb, domain * distance * distance, range);
                let wb = share.y * b.a * weight(b.rgb, origin.rgb, domain * distance * distance, range);
                sum += wa * vec4f(a.rgb, 1.0) + wb * vec4f(b.rgb, 1.0);
            } else {
                let tap = covered_between(source, 0u, q, next, f);
                let color = tap.rgb / max(tap.a, LEAST_COVERAGE);
                sum += weight(color, origin.rgb, domain * distance * distance, range) * tap;
            }
        }
    }
    let color = select(origin.rgb, sum.rgb / sum.a, sum.a > LEAST_COVERAGE);
    textureStore(target_image, vec2i(id.xy), vec4f(color, origin.a));
}
