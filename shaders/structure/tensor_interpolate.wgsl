// One level of the pyramid down: tensors that are not valid take the coarser level's, bilinearly
// (Listing 2.5). Cost: up to 5 loads.
#import gpu/grid
#import shared/sampling

struct Params {
    /// A tensor is valid from this w on.
    kept: f32,
}

#params
#input fine, coarse
#output target_image rgba32float

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    var t = fetch(fine, 0u, pixel(id));
    if t.w < params.kept {
        t = vec4f(sample_linear(coarse, 1u, 0.5 * centre(id)).xyz, 0.0);
    }
    textureStore(target_image, vec2i(id.xy), t);
}
