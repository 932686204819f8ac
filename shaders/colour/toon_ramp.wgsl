// Colours of surfaces in steps of light, with a rim and highlights of shapes of their own. Borders are as wide as about a
// pixel at least, by the gradient of what decides.
// Cost: 11 loads, nine powers and about 150 multiply-adds.
#import gpu/grid
#import shared/colour

struct Params {
    /// Gamma-encoded colour of each step, and the light from which on it is; that of the first is not used.
    steps: array<vec4f, 6>,
    /// Width of the borders of steps 1 to 4, in light; that of the first is not used.
    softness: vec4f,
    /// The same of steps 5 and 6.
    last_softness: vec2f,
    /// How far a surface turns away from where the rim begins, and width of its border.
    rim_from: vec2f,
    /// Gamma-encoded colour of the rim, and its strength, 0..=1.
    rim: vec4f,
    /// Gamma-encoded colour of highlights, and their strength, 0..=1.
    highlight: vec4f,
    /// Mirrored light from which on highlights are, and width of their border.
    highlight_from: vec2f,
    /// 1 where the colours to paint have light in them, which is divided out; 0 where they are surfaces'.
    own: u32,
}

#params
// Light, turn and mirrored light, and the coverage of the picture.
#input light
#input albedo, rest
#output target_image rgba32float

// Narrowest border, pixels, half of it.
const CRISPEST: f32 = 0.75;

// What is so dark is grey: its colour is noise.
const GREY: f32 = 0.01;

// By how much a neighbour exceeds the centre; where it is transparent it stands for the centre.
fn excess(p: vec2i, centre: vec4f) -> vec3f {
    let v = fetch(light, 0u, p);
    return (v.xyz - centre.xyz) * v.w;
}

// 0 below a border, 1 above it.
fn above(value: f32, from_value: f32, softness: f32, slope: f32) -> f32 {
    let half_width = max(max(0.5 * softness, CRISPEST * slope), 1e-3);
    let t = clamp(0.5 + (value - from_value) / (2.0 * half_width), 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}

fn softness_of(step: u32) -> f32 {
    if step < 4u {
        return params.softness[step];
    }
    return params.last_softness[step - 4u];
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = pixel(id);
    let centre = fetch(light, 0u, p);
    let left_up = excess(p + vec2i(-1, -1), centre);
    let left_down = excess(p + vec2i(-1, 1), centre);
    let right_up = excess(p + vec2i(1, -1), centre);
    let right_down = excess(p + vec2i(1, 1), centre);
    let x = 0.5 * (excess(p + vec2i(1, 0), centre) - excess(p - vec2i(1, 0), centre))
        + 0.25 * ((right_up - left_up) + (right_down - left_down));
    let y = 0.5 * (excess(p + vec2i(0, 1), centre) - excess(p - vec2i(0, 1), centre))
        + 0.25 * ((left_down - left_up) + (right_down - right_up));
    let slope = 0.5 * sqrt(x * x + y * y);

    var tint = params.steps[0].rgb;
    for (var i = 1u; i < 6u; i++) {
        tint = mix(tint, params.steps[i].rgb, above(centre.x, params.steps[i].w, softness_of(i), slope.x));
    }
    let surface = fetch(albedo, 1u, p);
    var colour = srgb_decode(surface.rgb);
    if params.own != 0u {
        let luminance = max(dot(colour, vec3f(0.2126729, 0.7151522, 0.0721750)), 0.0);
        colour = (max(colour, vec3f(0.0)) + GREY) / (luminance + GREY);
    }
    let rim = params.rim.a * above(centre.y, params.rim_from.x, params.rim_from.y, slope.y);
    let shine = params.highlight.a * above(centre.z, params.highlight_from.x, params.highlight_from.y, slope.z);
    colour = mix(colour * srgb_decode(tint), srgb_decode(params.rim.rgb), rim);
    colour = mix(colour, srgb_decode(params.highlight.rgb), shine);
    let others = fetch(rest, 2u, p);
    if params.own == 0u {
        // As far as the layer covers the picture's pixel.
        colour = colour * saturate(surface.a / max(centre.w, 1e-4)) + srgb_decode(others.rgb);
    }
    textureStore(target_image, vec2i(id.xy), vec4f(srgb_encode(colour), centre.w));
}
