// White noise by a hash of each pixel's place in the full-size picture, grey and opaque.
// Cost: about 15 integer operations.
#import grid

struct Params {
    // Pixels of the full-size picture per pixel.
    pixel_size: f32,
    seed: u32,
}

@group(0) @binding(1) var<uniform> params: Params;
@group(0) @binding(2) var target_image: texture_storage_2d<rgba32float, write>;

fn mixed(v: u32) -> u32 {
    var h = v;
    h = (h ^ (h >> 16u)) * 0x7feb352du;
    h = (h ^ (h >> 15u)) * 0x846ca68bu;
    return h ^ (h >> 16u);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let place = vec2u(vec2i(floor(centre(id) * params.pixel_size)));
    let h = mixed(mixed(place.y ^ params.seed) + place.x);
    // The upper 24 bits: every value is exact in a float.
    let value = f32(h >> 8u) / 16777216.0;
    textureStore(target_image, vec2i(id.xy), vec4f(vec3f(value), 1.0));
}
