// The host's colour to the working colour: finite, not premultiplied, gamma-encoded Rec. 709.
// Cost: one load and three powers.
#import grid
#import colour

struct Params {
    // 0 sRGB, 1 linear Rec. 709, 2 ACEScg.
    space: u32,
    premultiplied: u32,
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
    // Compared by bits: shader compilers may assume that NaN does not exist.
    let bits = bitcast<vec4u>(v);
    let special = (bits & vec4u(0x7f800000u)) == vec4u(0x7f800000u);
    let nan = special & ((bits & vec4u(0x007fffffu)) != vec4u(0u));
    let largest = select(vec4f(65504.0), vec4f(-65504.0), (bits >> vec4u(31u)) == vec4u(1u));
    v = select(select(v, largest, special), vec4f(0.0), nan);
    v = clamp(v, vec4f(vec3f(-65504.0), 0.0), vec4f(vec3f(65504.0), 1.0));
    if params.premultiplied != 0u {
        v = vec4f(select(vec3f(0.0), v.rgb / v.a, v.a > 1e-6), v.a);
    }
    if params.space == 2u {
        v = vec4f(acescg_to_linear(v.rgb), v.a);
    }
    if params.space != 0u {
        v = vec4f(srgb_encode(v.rgb), v.a);
    }
    textureStore(target_image, vec2i(id.xy), v);
}
