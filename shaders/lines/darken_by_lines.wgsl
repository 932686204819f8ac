// Lightness times edge image: the input of the next iteration of the flow-based difference of
// Gaussians, whose lines thus grow coherent.
// Cost: two loads and a multiplication.
#import gpu/grid

@group(0) @binding(2) var lightness: texture_2d<f32>;
@group(0) @binding(3) var edges: texture_2d<f32>;
@group(0) @binding(4) var target_image: texture_storage_2d<rg32float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let v = fetch(lightness, 0u, pixel(id));
    let edge = clamp(fetch(edges, 1u, pixel(id)).x, 0.0, 1.0);
    textureStore(target_image, vec2i(id.xy), vec4f(v.x * edge, v.y, 0.0, 0.0));
}
