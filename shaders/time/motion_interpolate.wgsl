// A motion field at twice the resolution, where motions are twice as many pixels long. Cost: 4 loads.
#import shared/sampling

@group(0) @binding(2) var coarse: texture_2d<f32>;
@group(0) @binding(3) var target_image: texture_storage_2d<rg32float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    textureStore(target_image, vec2i(id.xy), sample_linear(coarse, 0u, 0.5 * centre(id)) * 2.0);
}
