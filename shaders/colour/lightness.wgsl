// Lightness L (0..100) and coverage of a colour, as (L alpha, alpha): what the line filters work on.
// Both are linear, so that smoothing and interpolation weight by coverage of themselves.
// Cost: one load and four powers; none when the source is Lab already.
#import grid
#import colour

struct Params {
    // 0 working colour, 1 Lab.
    source_space: u32,
}

@group(0) @binding(1) var<uniform> params: Params;
@group(0) @binding(2) var source: texture_2d<f32>;
@group(0) @binding(3) var target_image: texture_storage_2d<rg32float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let v = fetch(source, 0u, pixel(id));
    var lightness = v.x;
    if params.source_space == 0u {
        let y = dot(srgb_decode(v.rgb), vec3f(0.2126729, 0.7151522, 0.0721750));
        lightness = 116.0 * lab_curve(vec3f(y)).x - 16.0;
    }
    textureStore(target_image, vec2i(id.xy), vec4f(lightness * v.a, v.a, 0.0, 0.0));
}
