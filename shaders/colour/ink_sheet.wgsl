// Lays ink, graphite, charcoal or chalk on paper (section 4.3, 4.4): the response of a difference of
// Gaussians, roughened by strokes, is thresholded to lines and masses; shading is hatched or rubbed in; both
// catch on the paper's grain. Cells of grain and hatching are those of the full-size picture.
// Cost: five loads, 36 hashes and about 150 multiply-adds.
#import gpu/grid
#import shared/value_noise

struct Params {
    /// RGB and opacity of the ink.
    line: vec4f,
    /// RGB of the paper.
    paper: vec4f,
    /// Response from which on there is no ink, units of L.
    epsilon: f32,
    /// Steepness of the ramp to ink, per unit of L.
    phi: f32,
    /// Units of L by which strokes raise and lower the response.
    carving: f32,
    /// How dark shading is, 0..=2.
    shading: f32,
    /// How much of the shading is hatched, 0..=1; the rest is rubbed in.
    hatching: f32,
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
    /// Where the picture stands in the canonical one, pixels.
    origin: vec2f,
    /// Nonzero: hatching is that of the last two images.
    given: u32,
}

@group(0) @binding(1) var<uniform> params: Params;
@group(0) @binding(2) var response: texture_2d<f32>;
@group(0) @binding(3) var source: texture_2d<f32>;
@group(0) @binding(4) var strokes: texture_2d<f32>;
@group(0) @binding(5) var first_hatching: texture_2d<f32>;
@group(0) @binding(6) var second_hatching: texture_2d<f32>;
@group(0) @binding(7) var target_image: texture_storage_2d<rgba32float, write>;

// Noise whose values fill 0..1.
fn even(v: f32) -> f32 {
    return clamp(0.5 + 1.7 * (v - 0.5), 0.0, 1.0);
}

// How much ink of density `d` catches where the height is `h`, for a grain of depth `depth`: as much on the
// average, more in the one place and less in the other; none is none and solid is solid.
fn catches(d: f32, h: f32, depth: f32) -> f32 {
    return clamp(d + depth * 4.0 * d * (1.0 - d) * (0.5 - h), 0.0, 1.0);
}

// Heights of pencil strokes that run along `along`.
fn hatch(q: vec2f, along: vec2f, seed: u32) -> f32 {
    let p = vec2f(dot(q, along), q.y * along.x - q.x * along.y);
    return even(0.7 * value_noise(p * vec2f(0.025, 0.45), seed) + 0.3 * value_noise(p * vec2f(0.06, 1.0), seed + 57u));
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let q = (centre(id) + params.origin) * params.inverse_scale;
    let g = q * params.grain_frequency;
    let tooth = even(0.45 * value_noise(g, 11u) + 0.25 * value_noise(g * 2.13, 1013u)
        + 0.3 * value_noise(g * 0.31, 2027u));
    let v = fetch(source, 1u, pixel(id));
    let alpha = clamp(v.a, 0.0, 1.0);

    let stroke = clamp(fetch(strokes, 2u, pixel(id)).x, 0.0, 1.0);
    let u = fetch(response, 0u, pixel(id)).x + params.carving * (2.0 * stroke - 1.0);
    let lines = select(-tanh(max(params.phi * (u - params.epsilon), -20.0)), 0.0, u >= params.epsilon);

    let dark = 1.0 - clamp(dot(v.rgb, vec3f(0.2126, 0.7152, 0.0722)), 0.0, 1.0);
    let tone = clamp(params.shading * (1.06 * dark - 0.06), 0.0, 1.0);
    let deep = clamp(params.shading * (1.7 * dark - 0.9), 0.0, 1.0);
    var first = fetch(first_hatching, 3u, pixel(id)).x;
    var second = fetch(second_hatching, 4u, pixel(id)).x;
    if params.given == 0u {
        first = hatch(q, vec2f(0.8, -0.6), 301u);
        second = hatch(q, vec2f(0.96, 0.28), 701u);
    }
    first = mix(tooth, first, params.hatching);
    second = mix(tooth, second, params.hatching);
    // Strokes leave the paper between them; what is rubbed in follows the grain only a little.
    let depth = 0.4 + 1.2 * params.hatching;
    let shade = max(catches(tone * tone, first, depth), catches(deep, second, depth));
    let drawn = 1.0 - (1.0 - lines) * (1.0 - 0.75 * shade);
    let height = mix(tooth, stroke, params.follow);
    let ink = catches(drawn, height, params.grain) * (1.0 - 0.25 * params.grain * tooth) * params.line.a * alpha;

    // Chalk: the picture's own colours, a little lighter, where the paper catches them.
    let own = clamp(v.rgb, vec3f(0.0), vec3f(1.0));
    let chalk = catches(0.72, height, params.grain) * params.colour * alpha;
    let paper = params.paper.rgb * (1.0 + params.texture_amount * (tooth - 0.5));
    let laid = mix(paper, own * 0.88 + 0.12, chalk);
    let colour = mix(params.line.rgb, own * 0.3, params.colour);
    textureStore(target_image, vec2i(id.xy), vec4f(mix(laid, colour, ink), select(v.a, 1.0, params.cover != 0u)));
}
