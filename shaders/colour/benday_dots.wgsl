// Prints colours as dots of one ink on white paper or, where they are darker, on a tint of the same ink, as comics were
// printed (section 1.2); darks and pure colours are solid. Inks mix as linear light, and their mean is the colour.
// Cost: two loads, seven powers and about 110 multiply-adds.
#import gpu/grid
#import shared/colour
#import shared/halftone_dots
#import shared/mark_tones

struct Params {
    /// Cosine and sine of the screen's angle over the size of a cell.
    screen: vec2f,
    /// Where the picture stands in the canonical one, pixels.
    origin: vec2f,
    /// 1 / size of a cell, 1/pixel.
    frequency: f32,
    /// How much of the screen is seen, 0..=1: not all of it where cells are smaller than two pixels.
    depth: f32,
    /// How much of the colours is printed, 0..=1.
    amount: f32,
    /// Opacity of the lines, which are not printed.
    opacity: f32,
}

#params
// The picture, and where it has no lines.
#input source, edges
#output target_image rgba32float

// Share of the paper that the largest dots cover; luminance of the darkest ink; the share of ink from which on dots close;
// and those below which paper is bare, and from which on it is not.
const LARGEST: f32 = 0.36;
const DARKEST_INK: f32 = 0.2;
const CLOSING: f32 = 0.8;
const BARE: f32 = 0.02;
const INKED: f32 = 0.08;

fn of_pixel(id: vec3u, v: vec4f, edges: vec4f) -> vec4f {
    let light = srgb_decode(v.rgb);
    // What is brighter than paper shines through it.
    let paper = max(light, vec3f(1.0));
    let taken = paper - light;
    // The share that the darkest ink of this hue would cover: one whose least channel is 0, if that is light enough.
    let strongest = max(max(taken.r, taken.g), taken.b);
    let luminance = dot(taken, vec3f(0.2126729, 0.7151522, 0.0721750));
    let solid = clamp(max(strongest, luminance * (1.0 / (1.0 - DARKEST_INK))), 1e-4, 1.0);
    let share = select(LARGEST, solid - solid * solid * (0.25 / LARGEST), solid < 2.0 * LARGEST);
    let x = centre(id) + params.origin;
    let q = vec2f(x.x * params.screen.x - x.y * params.screen.y, x.x * params.screen.y + x.y * params.screen.x);
    let seen = clamp(discs_at(q, share, params.screen, params.frequency), 0.0, 1.0);
    let open = 1.0 - rise((solid - CLOSING) * (1.0 / (1.0 - CLOSING)));
    let contrast = (1.0 / solid - 1.0) / (1.0 - share) * open * params.depth;
    let ink = (1.0 + contrast * (seen - share)) * rise((solid - BARE) * (1.0 / (INKED - BARE)));
    let amount = params.amount * (1.0 - params.opacity * (1.0 - clamp(edges.x, 0.0, 1.0)));
    return vec4f(srgb_encode(paper - taken * (1.0 + amount * (ink - 1.0))), v.a);
}
