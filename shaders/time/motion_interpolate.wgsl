// A motion field at twice the resolution, where motions are twice as many pixels long. Cost: 4 loads.
#import shared/sampling

#input coarse
#output target_image rg32float

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    textureStore(target_image, vec2i(id.xy), sample_linear(coarse, 0u, 0.5 * centre(id)) * 2.0);
}
