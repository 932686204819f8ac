// Lines without what they were drawn over: their colour, and as alpha how much of the pixel they cover (section 4.6).
// Cost: three loads, a division and six multiply-adds.
#import gpu/grid

struct Params {
    /// Opacity of the lines, 0..=1.
    opacity: f32,
}

#params
// The picture with its lines, the same without them, and the lines: 1 = paper, 0 = line.
#input drawn, source, edges
#output target_image rgba32float

// Share of a pixel below which the colour of what covers it is lost in rounding.
const LEAST_SHARE: f32 = 1e-3;

fn of_pixel(id: vec3u, drawn: vec4f, v: vec4f, edges: vec4f) -> vec4f {
    let share = (1.0 - clamp(edges.x, 0.0, 1.0)) * params.opacity;
    let line = v.rgb + (drawn.rgb - v.rgb) / max(share, LEAST_SHARE);
    return vec4f(clamp(line, vec3f(0.0), vec3f(1.0)), share * clamp(v.a, 0.0, 1.0));
}
