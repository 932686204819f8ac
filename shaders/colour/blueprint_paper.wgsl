// The sheet of a blueprint: tinted paper with texture and grid, a hint of the picture's tones and the
// lines. All lengths and the texture's cells are those of the full-size picture, so that tiles and
// proxies show the same sheet.
// Cost: three loads, twelve hashes and about 100 multiply-adds.
#import shared/value_noise
#import gpu/grid

struct Params {
    /// RGB and opacity of the lines.
    line: vec4f,
    /// RGB of the paper.
    paper: vec4f,
    /// Pixels between grid lines; 0 for none.
    spacing: f32,
    /// Rendered size over full size.
    scale: f32,
    /// 1 / scale.
    inverse_scale: f32,
    /// Strength of the paper's texture, 0..=1.
    texture_amount: f32,
    /// How much of the picture's tones shows, 0..=1.
    fill: f32,
    /// Nonzero: the sheet is opaque also where the picture is not.
    cover: u32,
    /// Where the picture stands in the canonical one, pixels.
    origin: vec2f,
    /// Nonzero: its colours are those of the given sheet.
    given: u32,
    /// Nonzero: lines are drawn.
    lined: u32,
}

#params
#input lightness, edges
// Colours of a given paper.
#input given_sheet
#output target_image rgba32float

// How much of a pixel at `x` is covered by lines `width` wide, `spacing` apart.
fn ruled(x: vec2f, spacing: f32, width: f32) -> f32 {
    let offset = x - spacing * (floor(x / spacing) + 0.5);
    let covered = clamp(0.5 + 0.5 * width - abs(offset), vec2f(0.0), vec2f(min(width, 1.0)));
    return max(covered.x, covered.y);
}

fn of_pixel(id: vec3u, lightness: vec4f, edges: vec4f, given_sheet: vec4f) -> vec4f {
    let x = centre(id) + params.origin;
    let q = x * params.inverse_scale;
    var paper = given_sheet.rgb;
    if params.given == 0u {
        let grain = 0.45 * value_noise(q * 0.4, 0u) + 0.3 * value_noise(q * 0.13, 1013u) + 0.25 * value_noise(q * 0.037, 2027u);
        paper = vec3f(1.0 + params.texture_amount * (grain - 0.5));
    }
    let v = lightness.xy;
    let tone = clamp(v.x / max(v.y, 1e-6) * 0.01, 0.0, 1.0);
    let fill = params.fill * clamp(v.y, 0.0, 1.0);
    var sheet = params.paper.rgb * (paper * (1.0 - 0.5 * fill * (1.0 - tone)));
    sheet += 0.35 * fill * tone * (params.line.rgb - sheet);
    if params.spacing > 0.0 {
        let fine = 0.16 * ruled(x, params.spacing, params.scale);
        let strong = 0.32 * ruled(x, 5.0 * params.spacing, 1.5 * params.scale);
        sheet += max(fine, strong) * params.line.a * (params.line.rgb - sheet);
    }
    let ink = select(0.0, (1.0 - clamp(edges.x, 0.0, 1.0)) * params.line.a, params.lined != 0u);
    let alpha = select(v.y, 1.0, params.cover != 0u);
    return vec4f(sheet + ink * (params.line.rgb - sheet), alpha);
}
