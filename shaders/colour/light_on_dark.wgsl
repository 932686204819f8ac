// Draws lines over a picture, or over paper in its place: dark ones on light ground, and light ones where the ground
// around is darker than a dark line can show; coverage stays.
// Cost: three loads, a division and 20 multiply-adds.
#import gpu/grid
#import shared/coverage

struct Params {
    /// RGB and opacity of the lines.
    line: vec4f,
    /// RGB of the lines on dark ground, and how far it counts against what lies under them, 0..=1.
    light: vec4f,
    /// RGB of the paper and how much of it covers the picture.
    paper: vec4f,
    /// Lightness of the ground from which down lines turn light, units of L.
    dark: f32,
    /// 1 / the units of L over which they do.
    inverse: f32,
}

#params
// The third holds moments around each pixel (L alpha, L^2 alpha, alpha).
#input source, edges, ground
#output target_image rgba32float

fn of_pixel(id: vec3u, v: vec4f, edges: vec4f, ground: vec4f) -> vec4f {
    let ink = (1.0 - clamp(edges.x, 0.0, 1.0)) * params.line.a;
    let base = v.rgb + params.paper.a * (params.paper.rgb - v.rgb);
    let mean = ground.x / max(ground.z, LEAST_COVERAGE);
    let t = clamp((params.dark - mean) * params.inverse, 0.0, 1.0);
    let turned = t * t * (3.0 - 2.0 * t);
    let light = base + params.light.a * (params.light.rgb - base);
    let drawn = params.line.rgb + turned * (light - params.line.rgb);
    return vec4f(base + ink * (drawn - base), v.a);
}
