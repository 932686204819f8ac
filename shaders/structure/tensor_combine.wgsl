// A smoothed tensor and that of the next coarser level, upsampled, weighted by their anisotropies
// (2.172, 2.173). The anisotropy of the coarser level is upsampled itself, not found from the upsampled tensor.
// Cost: 5 loads and about 110 operations.
#import gpu/grid
#import shared/tensor

// Where both anisotropies together are not above this, the finer tensor stays.
const LEAST: f32 = 1e-6;

#input fine, coarse
#output target_image rgba32float

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let own = fetch(fine, 0u, pixel(id));
    let q = 0.5 * centre(id) - 0.5;
    let corner = floor(q);
    let f = q - corner;
    let i = vec2i(corner);
    let p00 = fetch(coarse, 1u, i);
    let p10 = fetch(coarse, 1u, i + vec2i(1, 0));
    let p01 = fetch(coarse, 1u, i + vec2i(0, 1));
    let p11 = fetch(coarse, 1u, i + vec2i(1, 1));
    let above = mix(mix(p00, p10, f.x), mix(p01, p11, f.x), f.y);
    let upper = mix(tensor_anisotropy(p00), tensor_anisotropy(p10), f.x);
    let lower = mix(tensor_anisotropy(p01), tensor_anisotropy(p11), f.x);
    let a = tensor_anisotropy(own);
    let sum = a + mix(upper, lower, f.y);
    var alpha = 1.0;
    if sum > LEAST {
        alpha = a / sum;
    }
    textureStore(target_image, vec2i(id.xy), above + (own - above) * alpha);
}
