// The stylized picture into the viewport.

@group(0) @binding(2) var stylized: texture_2d<f32>;
@group(0) @binding(3) var target_color: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let place = vec2i(id.xy);
    if all(place < vec2i(textureDimensions(target_color))) {
        textureStore(target_color, place, textureLoad(stylized, place, 0));
    }
}
