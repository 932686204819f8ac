// The light of a picture beyond what its coverage can carry, as an opaque picture in the host's own space.
// Cost: one load and about ten operations.
#import gpu/grid
#import shared/host_colour

@group(0) @binding(2) var source: texture_2d<f32>;
@group(0) @binding(3) var target_image: texture_storage_2d<rgba32float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    textureStore(target_image, vec2i(id.xy), vec4f(beyond_coverage(finite(fetch(source, 0u, pixel(id)))), 1.0));
}
