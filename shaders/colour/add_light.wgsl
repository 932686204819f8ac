// A premultiplied picture and light that is added to it.
// Cost: two loads and three additions.
#import gpu/grid

@group(0) @binding(2) var picture: texture_2d<f32>;
@group(0) @binding(3) var light: texture_2d<f32>;
@group(0) @binding(4) var target_image: texture_storage_2d<rgba32float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let under = fetch(picture, 0u, pixel(id));
    textureStore(target_image, vec2i(id.xy), vec4f(under.rgb + fetch(light, 1u, pixel(id)).rgb, under.a));
}
