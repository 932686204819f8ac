// Colours of lines that a host gives, over those that lines have by themselves.
// Cost: two loads and three multiply-adds.
#import gpu/grid

struct Params {
    /// RGB and opacity of lines without colours by kind.
    line: vec4f,
    /// 1 where lines have colours by kind, those of `own`.
    by_kind: u32,
}

#params
// RGB and how much it counts; RGB and opacity of lines.
#input given, own
#output target_image rgba32float

fn of_pixel(id: vec3u, given: vec4f, own: vec4f) -> vec4f {
    let line = select(params.line, own, params.by_kind > 0u);
    return vec4f(line.rgb + clamp(given.a, 0.0, 1.0) * (given.rgb - line.rgb), line.a);
}
