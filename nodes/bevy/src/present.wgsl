// The stylized picture in the camera's viewport, and what lies around it as it was.

@group(0) @binding(0) var<uniform> viewport: vec4i;
@group(0) @binding(1) var plain: texture_2d<f32>;
@group(0) @binding(2) var stylized: texture_2d<f32>;

@vertex
fn cover_target(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    let corner = vec2f(f32(index & 1u), f32(index >> 1u)) * 4.0 - 1.0;
    return vec4f(corner, 0.0, 1.0);
}

@fragment
fn present(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let texel = vec2i(position.xy);
    let place = texel - viewport.xy;
    if all(place >= vec2i(0)) && all(place < viewport.zw) {
        return textureLoad(stylized, place, 0);
    }
    return textureLoad(plain, texel, 0);
}
