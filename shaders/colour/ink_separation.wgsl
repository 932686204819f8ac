// Separates a picture into printing plates: the share of the paper that each ink covers. Shares are of light: what
// they print has, seen from afar, the picture's own light against that of the paper.
// Cost: one load and about 20 multiply-adds for one ink, 400 for three and black.
#import gpu/grid
#import shared/colour

struct Params {
    /// Light that each of three inks takes from the paper, linear RGB, 0..=1.
    inks: array<vec4f, 3>,
    /// Factor on the colour axes.
    chroma: f32,
    /// Plates: 1 for lightness alone, 3 for the three inks, 4 for these and black.
    plates: u32,
    /// Share of the common grey of three inks that black prints instead, 0..=1.
    replaced: f32,
    /// Light that black takes from the paper, 0..=1.
    black: f32,
    /// Nonzero: the only ink prints the lights.
    lights: u32,
}

#params
// CIELAB.
#input source
#output target_image rgba32float

const LUMINANCE: vec3f = vec3f(0.2126729, 0.7151522, 0.0721750);
// Weight of differences of luminance beside those of the channels, and the least length of an ink's light, squared, at
// which it counts in full.
const LIGHT: f32 = 3.0;
const FAINT: f32 = 2e-3;

// Product of two differences of colour.
fn agreement(a: vec3f, b: vec3f) -> f32 {
    return dot(a, b) + LIGHT * dot(a, LUMINANCE) * dot(b, LUMINANCE);
}

// The share of an ink that takes `taken` of what the others leave, nearest to `wanted`.
fn share(left: vec3f, wanted: vec3f, taken: vec3f) -> f32 {
    let change = left * taken;
    return clamp(agreement(left - wanted, change) / (agreement(change, change) + FAINT), 0.0, 1.0);
}

fn of_pixel(id: vec3u, lab: vec4f) -> vec4f {
    let alpha = clamp(lab.a, 0.0, 1.0);
    if params.plates == 1u {
        let light = clamp(lab_curve_inverse(vec3f((lab.x + 16.0) / 116.0)).x, 0.0, 1.0);
        return vec4f(select(1.0 - light, light, params.lights != 0u), 0.0, 0.0, 0.0) * alpha;
    }
    let linear = lab_to_linear(lab.rgb * vec3f(1.0, params.chroma, params.chroma));
    var wanted = clamp(linear, vec3f(0.0), vec3f(1.0));
    var black = 0.0;
    if params.plates == 4u {
        let grey = 1.0 - max(max(wanted.r, wanted.g), wanted.b);
        black = params.replaced * grey;
        wanted = min(wanted / (1.0 - black * params.black), vec3f(1.0));
    }
    let first = params.inks[0].rgb;
    let second = params.inks[1].rgb;
    let third = params.inks[2].rgb;
    var s = vec3f(0.0);
    for (var round = 0; round < 4; round++) {
        s.x = share((1.0 - s.y * second) * (1.0 - s.z * third), wanted, first);
        s.y = share((1.0 - s.x * first) * (1.0 - s.z * third), wanted, second);
        s.z = share((1.0 - s.x * first) * (1.0 - s.y * second), wanted, third);
    }
    return vec4f(s, black) * alpha;
}
