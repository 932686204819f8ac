// Colours of a palette in the place of those of a picture: the nearest in CIELAB, or, by ordered dither, that or a second
// one, whichever the threshold of the place says. What is written is copied from the palette and never computed.
// Cost: one load, and about 12 operations for each colour of the palette, 15 more where it dithers.
#import gpu/grid

struct Params {
    /// Thresholds of a dither pattern, 0..1, 32 rows of 32, four to a vector.
    thresholds: array<vec4f, 256>,
    /// CIELAB of the colours.
    labs: array<vec4f, 64>,
    /// The colours themselves, gamma-encoded RGB.
    colours: array<vec4f, 64>,
    /// Where the picture stands in the canonical one, pixels.
    origin: vec2f,
    /// Factor on the picture's lightness, and what is added to it.
    tone: vec2f,
    /// 1 / size of a cell of the pattern, 1/pixel.
    frequency: f32,
    /// How far from the middle between two colours dither reaches, 0..=1; 0 takes the nearest colour.
    spread: f32,
    /// Number of colours, 1..=64.
    count: u32,
}

#params
#input source
#output target_image rgba32float

// Rows and columns of the pattern.
const SIDE: i32 = 32;
// How much nearer a second colour must lead to what is wanted, the farther it is, 1 / CIELAB units squared.
const COMPACT: f32 = 4e-5;
// Range of what is compared, to both sides of 0, CIELAB units: beyond it distances lose their last bits.
const REACH: f32 = 300.0;

// Threshold at absolute position p.
fn threshold(p: vec2f) -> f32 {
    let cell = vec2i(floor(p * params.frequency)) & vec2i(SIDE - 1);
    let at = u32(SIDE * cell.y + cell.x);
    return params.thresholds[at / 4u][at % 4u];
}

fn of_pixel(id: vec3u, v: vec4f) -> vec4f {
    let tone = v.x * params.tone.x + params.tone.y;
    let wanted = clamp(vec3f(tone, v.yz), vec3f(-REACH), vec3f(REACH));
    let count = params.count;
    var chosen = 0u;
    var apart = 1e30;
    for (var i = 0u; i < count; i++) {
        let d = wanted - params.labs[i].xyz;
        let square = dot(d, d);
        if square < apart {
            apart = square;
            chosen = i;
        }
    }
    if params.spread > 0.0 {
        // The second is where the line from the first on leads nearest to what is wanted.
        let first = params.labs[chosen].xyz;
        let d = wanted - first;
        var second = chosen;
        var best = -1e30;
        var share = 0.0;
        for (var i = 0u; i < count; i++) {
            let line = params.labs[i].xyz - first;
            let along = dot(d, line);
            let square = dot(line, line);
            let merit = along * along / max(square, 1e-6) - COMPACT * square * apart;
            if along > 0.0 && merit > best {
                best = merit;
                second = i;
                share = along / max(square, 1e-6);
            }
        }
        // Where light and dark meet, thresholds say which pixels are light whichever of the two is nearer.
        let is_lighter = params.labs[second].x > first.x;
        let light = select(1.0 - share, share, is_lighter) - 0.5;
        let is_light = light > params.spread * (threshold(centre(id) + params.origin) - 0.5);
        chosen = select(chosen, second, is_light == is_lighter);
    }
    return vec4f(params.colours[chosen].rgb, v.a);
}
