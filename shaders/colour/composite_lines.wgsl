// Draws lines over a picture, or over paper in its place (section 4.6); coverage stays.
// Cost: two loads and eight multiply-adds.
#import gpu/grid

struct Params {
    /// RGB and opacity of the lines.
    line: vec4f,
    /// RGB of the paper and how much of it covers the picture.
    paper: vec4f,
}

@group(0) @binding(1) var<uniform> params: Params;
@group(0) @binding(2) var source: texture_2d<f32>;
@group(0) @binding(3) var edges: texture_2d<f32>;
@group(0) @binding(4) var target_image: texture_storage_2d<rgba32float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let v = fetch(source, 0u, pixel(id));
    let ink = (1.0 - clamp(fetch(edges, 1u, pixel(id)).x, 0.0, 1.0)) * params.line.a;
    let base = v.rgb + params.paper.a * (params.paper.rgb - v.rgb);
    textureStore(target_image, vec2i(id.xy), vec4f(base + ink * (params.line.rgb - base), v.a));
}
