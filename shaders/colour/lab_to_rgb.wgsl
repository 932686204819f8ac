// CIELAB to working colour; alpha passes.
// Cost: one load and three powers.
#import gpu/grid
#import shared/colour

struct Params {
    /// Factor on the colour axes: 0 is grey, 1 leaves the saturation alone.
    chroma: f32,
}

@group(0) @binding(1) var<uniform> params: Params;
@group(0) @binding(2) var source: texture_2d<f32>;
@group(0) @binding(3) var target_image: texture_storage_2d<rgba32float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    var v = fetch(source, 0u, pixel(id));
    v = vec4f(srgb_encode(lab_to_linear(v.rgb * vec3f(1.0, params.chroma, params.chroma))), v.a);
    textureStore(target_image, vec2i(id.xy), v);
}
