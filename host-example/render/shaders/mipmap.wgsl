// Halves an image for its next smaller copy; bilinear sampling between four texels is their mean.

@group(0) @binding(0) var larger: texture_2d<f32>;
@group(0) @binding(1) var bilinear: sampler;

struct Corner {
    @builtin(position) clip: vec4f,
    @location(0) uv: vec2f,
}

@vertex
fn mipmap_vertex(@builtin(vertex_index) index: u32) -> Corner {
    let uv = vec2f(f32(index & 1u), f32(index >> 1u)) * 2.0;
    return Corner(vec4f(uv * vec2f(2.0, -2.0) + vec2f(-1.0, 1.0), 0.0, 1.0), uv);
}

@fragment
fn mipmap_fragment(in: Corner) -> @location(0) vec4f {
    return textureSampleLevel(larger, bilinear, in.uv, 0.0);
}
