// A smoothed tensor and that of the next coarser level, upsampled, weighted by their anisotropies
// (2.172, 2.173). Cost: 5 loads and about 50 operations.
#import gpu/grid
#import shared/sampling
#import shared/tensor

// Where both anisotropies together are not above this, the finer tensor stays.
const LEAST: f32 = 1e-6;

@group(0) @binding(2) var fine: texture_2d<f32>;
@group(0) @binding(3) var coarse: texture_2d<f32>;
@group(0) @binding(4) var target_image: texture_storage_2d<rgba32float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let own = fetch(fine, 0u, pixel(id));
    let above = sample_linear(coarse, 1u, 0.5 * centre(id));
    let a = tensor_anisotropy(own);
    let sum = a + tensor_anisotropy(above);
    var alpha = 1.0;
    if sum > LEAST {
        alpha = a / sum;
    }
    textureStore(target_image, vec2i(id.xy), above + (own - above) * alpha);
}
