// Prints plates through halftone screens on paper (section 1.2). What a pixel of the result shows is the mean of its ink
// under a filter about a pixel wide, found from the shape of the dots, so that no screen beats with the pixels; the mean
// over a cell is the share that the plate asks for. Inks and paper mix as linear light.
// Cost: for one ink two loads, three powers and about 180 multiply-adds; where the paper has a texture, 12 hashes more.
#import gpu/grid
#import shared/colour
#import shared/halftone_dots
#import shared/sampling
#import shared/value_noise

struct Params {
    /// Per plate: cosine and sine of its angle over the size of a cell, and how far the plate is moved, pixels.
    screens: array<vec4f, 4>,
    /// Per plate: linear RGB factors on what lies below its ink, and where in a cell its rings begin, 0..=1.
    keeps: array<vec4f, 4>,
    /// Per plate: linear RGB that its ink adds.
    adds: array<vec4f, 4>,
    /// Linear RGB of the paper.
    paper: vec4f,
    /// Where the picture stands in the canonical one, pixels.
    origin: vec2f,
    /// Middle of the rings in the canonical picture, pixels.
    centre: vec2f,
    /// 1 / size of a cell, 1/pixel.
    frequency: f32,
    /// Half the width of the borders of lines and squares, cells, up to 0.5.
    border: f32,
    /// Least width of the borders of dots, in shares of the paper.
    blur: f32,
    /// 0 dots, 1 lines, 2 rings, 3 squares.
    shape: u32,
    /// Number of plates, 1..=4.
    plates: u32,
    /// How much of the screen is seen, 0..=1: not all of it where cells are smaller than two pixels.
    depth: f32,
    /// Strength of the paper's texture.
    texture_amount: f32,
    /// Pixels of the full-size picture per pixel.
    inverse_scale: f32,
    /// Nonzero: the sheet is opaque also where the picture is not.
    cover: u32,
}

#params
// Shares of the paper that inks cover, times the coverage of the picture; the picture, for that coverage.
#input plates, source
#output target_image rgba32float

// Share of a triangle of -1..=1 that lies below x.
fn ramp(x: f32) -> f32 {
    let t = clamp(x, -1.0, 1.0);
    return 0.5 + t - 0.5 * t * abs(t);
}

// Stripes that cover `share` of every cell, a from the middle of one, under a triangle `params.border` to each side: its
// own borders and that of the next stripe.
fn stripe(a: f32, share: f32) -> f32 {
    let h = 1.0 / params.border;
    let half = 0.5 * share;
    return ramp((half - a) * h) - ramp((-half - a) * h) + ramp((a - 1.0 + half) * h);
}

// The paper that a plate covers at absolute position p.
fn covered(plate: u32, p: vec2f, share: f32) -> f32 {
    let screen = params.screens[plate];
    if params.shape == 2u {
        let arm = p - params.centre;
        let q = sqrt(dot(arm, arm)) * params.frequency + params.keeps[plate].w;
        return stripe(fold(vec2f(q)).x, share);
    }
    let q = vec2f(p.x * screen.x - p.y * screen.y, p.x * screen.y + p.y * screen.x);
    if params.shape == 0u {
        return dots_at(q, share, screen.xy, params.frequency, params.blur);
    }
    let a = fold(q);
    if params.shape == 1u {
        return stripe(a.y, share);
    }
    let side = sqrt(share);
    return stripe(a.x, side) * stripe(a.y, side);
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let x = centre(id) + params.origin;
    var light = params.paper.rgb;
    if params.texture_amount > 0.0 {
        let q = x * params.inverse_scale;
        let grain = 0.45 * value_noise(q * 0.4, 0u) + 0.3 * value_noise(q * 0.13, 1013u)
            + 0.25 * value_noise(q * 0.037, 2027u);
        light *= 1.0 + params.texture_amount * (grain - 0.5);
    }
    for (var plate = 0u; plate < params.plates; plate++) {
        let moved = params.screens[plate].zw;
        let share = clamp(sample_linear(plates, 0u, centre(id) - moved)[plate], 0.0, 1.0);
        let seen = clamp(covered(plate, x - moved, share), 0.0, 1.0);
        let ink = share + params.depth * (seen - share);
        light += ink * (light * (params.keeps[plate].rgb - 1.0) + params.adds[plate].rgb);
    }
    let alpha = fetch(source, 1u, pixel(id)).a;
    textureStore(target_image, vec2i(id.xy), vec4f(srgb_encode(light), select(alpha, 1.0, params.cover != 0u)));
}
