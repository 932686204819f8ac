// Motion as it enters: what is too long or no number is unknown.
// Cost: one load.
#import shared/motion

struct Params {
    /// Longest motion that counts, pixels.
    limit: f32,
}

@group(0) @binding(1) var<uniform> params: Params;
@group(0) @binding(2) var source: texture_2d<f32>;
@group(0) @binding(3) var target_image: texture_storage_2d<rg32float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let motion = bounded_motion(fetch(source, 0u, pixel(id)).xy, params.limit);
    textureStore(target_image, vec2i(id.xy), vec4f(motion, 0.0, 0.0));
}
