// Lays ink, graphite, charcoal or chalk on paper (section 4.3, 4.4): lines, and the marks of tones, both of which catch
// on the paper's grain. Cells of grain are those of the full-size picture.
// Cost: six loads, 12 hashes and about 100 multiply-adds.
#import gpu/grid
#import shared/coverage
#import shared/mark_tones
#import shared/value_noise

struct Params {
    /// RGB and opacity of the ink.
    line: vec4f,
    /// RGB of the paper.
    paper: vec4f,
    /// How deep the paper's grain is, 0..=2.
    grain: f32,
    /// Cells of grain per pixel of the full-size picture.
    grain_frequency: f32,
    /// Pixels of the full-size picture per pixel.
    inverse_scale: f32,
    /// How much of the picture's own colours shows, 0..=1.
    colour: f32,
    /// Strength of the paper's texture, 0..=1.
    texture_amount: f32,
    /// Nonzero: the sheet is opaque also where the picture is not.
    cover: u32,
    /// How much of the grain follows the strokes instead of the paper, 0..=1.
    follow: f32,
    /// How far what is drawn solidly, too, breaks on the grain, 0..=1.
    dryness: f32,
    /// Where the picture stands in the canonical one, pixels.
    origin: vec2f,
    /// How much of the paper own colours cover before anything is drawn, 0..=1.
    ground: f32,
    /// How light own colours are in what is drawn, 0..=1.
    tint: f32,
    /// Share of lines that is cut out of marks, 0..=1.
    cut: f32,
    /// L from which on tones are smooth.
    smooth_from: f32,
    /// 1 / the units of L over which grain shows.
    inverse_fade: f32,
    /// Nonzero: what is drawn alone, without the paper.
    bare: u32,
    /// Nonzero: colours and grain are those of the sheet.
    given: u32,
    /// Nonzero: lines have a colour at each pixel.
    painted: u32,
}

#params
// Black lines on white; in the second channel those that are cut out of marks. Where they are painted, see ink_paint.
#input lines
#input source, strokes
// The share of the paper that marks cover.
#input marks
// Those of the picture, (L alpha, alpha).
#input tones
// Colours of a given paper, and the depth of its grain.
#input sheet
#output target_image rgba32float

// Noise whose values fill 0..1.
fn even(v: f32) -> f32 {
    return clamp(0.5 + 1.7 * (v - 0.5), 0.0, 1.0);
}

// How much ink of density `d` catches where the height is `h`, for a grain of depth `depth`: as much on the
// average, more in the one place and less in the other; none is none and solid is solid.
fn catches(d: f32, h: f32, depth: f32) -> f32 {
    return clamp(d + depth * 4.0 * d * (1.0 - d) * (0.5 - h), 0.0, 1.0);
}

fn of_pixel(id: vec3u, lines: vec4f, v: vec4f, strokes: vec4f, marks: vec4f, tones: vec4f, sheet: vec4f) -> vec4f {
    let q = (centre(id) + params.origin) * params.inverse_scale;
    let g = q * params.grain_frequency;
    var tooth = sheet.w;
    var paper = params.paper.rgb * sheet.rgb;
    if params.given == 0u {
        tooth = even(0.45 * value_noise(g, 11u) + 0.25 * value_noise(g * 2.13, 1013u)
            + 0.3 * value_noise(g * 0.31, 2027u));
        paper = params.paper.rgb * (1.0 + params.texture_amount * (tooth - 0.5));
    }
    let alpha = clamp(v.a, 0.0, 1.0);
    let stroke = clamp(strokes.x, 0.0, 1.0);
    let height = mix(tooth, stroke, params.follow);

    let is_painted = params.painted != 0u;
    let line = 1.0 - clamp(select(lines.x, 1.0 - lines.w, is_painted), 0.0, 1.0);
    let grain = rise((params.smooth_from - tone_lightness(tones.xy)) * params.inverse_fade);
    // A dry tool leaves out the valleys of the paper even where it presses hard; in light tones nothing breaks.
    let dry = params.dryness * max(height - 0.55, 0.0);
    let pressed = catches(line, height, params.dryness * params.grain) * (1.0 - dry);
    let kept = 1.0 - (1.0 - clamp(select(lines.y, 1.0 + lines.w, is_painted), 0.0, 1.0)) * params.cut;
    let toned = catches(marks.x, height, params.grain * grain) * (1.0 - dry * grain) * kept;
    var drawn = (1.0 - (1.0 - pressed) * (1.0 - toned)) * params.line.a;
    var pen = params.line.rgb;
    if is_painted {
        drawn = 1.0 - (1.0 - pressed) * (1.0 - toned * params.line.a);
        pen += pressed / max(drawn, LEAST_COVERAGE) * (lines.rgb - pen);
    }
    let ink = drawn * alpha;

    // Chalk: the picture's own colours, a little lighter, where the paper catches them.
    let own = clamp(v.rgb, vec3f(0.0), vec3f(1.0));
    let chalk = catches(params.ground, height, params.grain * grain) * params.colour * alpha;
    let laid = mix(paper, own * 0.94 + 0.06, chalk);
    let colour = mix(pen, own * params.tint, params.colour);
    if params.bare != 0u {
        let covered = 1.0 - (1.0 - ink) * (1.0 - chalk);
        return vec4f(mix(own * 0.94 + 0.06, colour, ink / max(covered, LEAST_COVERAGE)), covered);
    }
    return vec4f(mix(laid, colour, ink), select(v.a, 1.0, params.cover != 0u));
}
