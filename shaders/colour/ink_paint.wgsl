// Lines of an ink sheet with a colour at each pixel: RGB, and in alpha how much of the pixel they cover, below 0 where they are
// cut out of marks.
// Cost: two loads.
#import gpu/grid

struct Params {
    /// Share of lines that is cut out of marks, 0..=1.
    cut: f32,
}

#params
// Black lines on white; in the second channel those that are cut out of marks.
#input lines
// RGB and opacity of lines.
#input paint
#output target_image rgba32float

fn of_pixel(id: vec3u, lines: vec4f, paint: vec4f) -> vec4f {
    let covered = (1.0 - clamp(lines.x, 0.0, 1.0)) * clamp(paint.a, 0.0, 1.0);
    let cut = (1.0 - clamp(lines.y, 0.0, 1.0)) * params.cut;
    return vec4f(paint.rgb, covered - cut);
}
