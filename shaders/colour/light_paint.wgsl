// Colours of lines, light where the ground around is darker than the line can show.
// Cost: three loads, a division and 25 multiply-adds.
#import gpu/grid
#import shared/coverage

struct Params {
    /// Lightness that a ground has above a line that is seen on it, units of L.
    seen: f32,
    /// 1 / the units of L over which lines turn.
    inverse: f32,
    /// Part of the way from the ground to white that light lines go.
    lift: f32,
    /// Strongest channel of lines at which none turns.
    strong: f32,
    /// 1 / the range of channels below it over which fewer do.
    inverse_range: f32,
}

#params
// RGB and opacity of lines, and the picture beneath.
#input paint, source
// Moments around each pixel (L alpha, L^2 alpha, alpha).
#input ground
#output target_image rgba32float

fn of_pixel(id: vec3u, paint: vec4f, v: vec4f, ground: vec4f) -> vec4f {
    // Greys have about as much lightness as they have of white.
    let own = 100.0 * dot(paint.rgb, vec3f(0.2126, 0.7152, 0.0722));
    let strongest = max(max(paint.r, paint.g), paint.b);
    let dark = (own + params.seen) * clamp((params.strong - strongest) * params.inverse_range, 0.0, 1.0);
    let mean = ground.x / max(ground.z, LEAST_COVERAGE);
    let t = clamp((dark - mean) * params.inverse, 0.0, 1.0);
    let turned = t * t * (3.0 - 2.0 * t);
    let light = v.rgb + params.lift * (1.0 - v.rgb);
    return vec4f(paint.rgb + turned * (light - paint.rgb), paint.a);
}
