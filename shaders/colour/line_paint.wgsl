// Colour and opacity of a line at each pixel: those of the kind of line that geometry draws there, and those of all other
// lines elsewhere.
// Cost: a load and about 50 operations.
#import gpu/grid

struct Params {
    /// RGB and opacity of lines of the picture's own edges.
    line: vec4f,
    /// The same of creases.
    crease: vec4f,
    /// The same of outlines.
    outline: vec4f,
    /// The same of borders between things that touch.
    border: vec4f,
    /// One over the density of a lone break at its middle.
    inverse_peak: f32,
}

#params
// Densities (crease, outline, border), smoothed.
#input kinds
#output target_image rgba32float

// Densities, against that of a lone break, from which on a line is not of the picture's own edges, and from which on it is
// of geometry alone.
const FROM: f32 = 0.12;
const INVERSE_RANGE: f32 = 5.0;

// Rank of creases, outlines and borders where several are as dense.
const RANKS: vec3f = vec3f(1.0, 1.6, 1.3);

// Least sum of weights that is divided by.
const LEAST: f32 = 1e-20;

fn of_pixel(id: vec3u, kinds: vec4f) -> vec4f {
    let density = clamp(kinds.xyz * params.inverse_peak, vec3f(0.0), vec3f(1.0));
    // The densest kind decides, and outlines before borders before creases.
    let ranked = density * RANKS;
    let squared = ranked * ranked;
    let weights = squared * squared * squared;
    let mean = weights.x * params.crease + weights.y * params.outline + weights.z * params.border;
    let own = mean / max(weights.x + weights.y + weights.z, LEAST);
    let t = clamp((max(max(density.x, density.y), density.z) - FROM) * INVERSE_RANGE, 0.0, 1.0);
    let share = t * t * (3.0 - 2.0 * t);
    return params.line + share * (own - params.line);
}
