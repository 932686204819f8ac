// Draws lines over a picture, or over paper in its place (section 4.6); coverage stays.
// Cost: two loads and eight multiply-adds.
#import gpu/grid

struct Params {
    /// RGB and opacity of the lines.
    line: vec4f,
    /// RGB of the paper and how much of it covers the picture.
    paper: vec4f,
}

#params
#input source, edges
#output target_image rgba32float

fn of_pixel(id: vec3u, v: vec4f, edges: vec4f) -> vec4f {
    let ink = (1.0 - clamp(edges.x, 0.0, 1.0)) * params.line.a;
    let base = v.rgb + params.paper.a * (params.paper.rgb - v.rgb);
    return vec4f(base + ink * (params.line.rgb - base), v.a);
}
