// Transparent paint on white paper: pigment has a density, which grows at the borders of dark regions, in
// clouds, in the grain of the paper and where water has pushed it to a rim (Bousseau et al. 2006). Wet places
// bleed; dry ones leave gaps beside dark shapes and bare peaks of the grain (Montesdeoca et al. 2017).
// Clouds and grain belong to the full-size picture, so that tiles and proxies show the same paper.
// Cost: five loads, 16 hashes and about 250 multiply-adds.
#import shared/value_noise
#import gpu/grid

struct Params {
    /// Pixels of the full-size picture per pixel.
    inverse_scale: f32,
    /// Share of the paper that the darkest paint covers.
    pigment: f32,
    /// Density gained per unit of luma by which the blurred picture is lighter.
    edges: f32,
    /// Density gained and lost in clouds.
    clouds: f32,
    /// Density gained and lost in the paper's grain.
    grain: f32,
    /// Cells of the grain per pixel of the full-size picture.
    grain_frequency: f32,
    /// Where the picture stands in the canonical one, pixels.
    origin: vec2f,
    /// Nonzero: clouds are those of the fourth image.
    given: u32,
    /// Square of the darkness of which paint covers half, against the light that is left.
    white: f32,
    /// Share of the colours around that wet places take.
    bleeding: f32,
    /// Share of the paint that is missing beside dark shapes.
    gaps: f32,
    /// Share of the paint that peaks of the grain do not take where the brush is dry.
    dry: f32,
    /// Density at the rim of water that ran back.
    backruns: f32,
    /// Nonzero: the paper is that of the fifth image.
    papered: u32,
}

#params
#input source, blurred, wide, given_clouds
// Colours of a given paper, and the depth of its grain.
#input sheet
#output target_image rgba32float

// Luma within the range of paper.
fn luma(c: vec3f) -> f32 {
    return clamp(dot(c, vec3f(0.2126, 0.7152, 0.0722)), 0.0, 1.0);
}

// A smooth step from 0 at `start` to 1 at start + 1 / inverse.
fn rise(v: f32, start: f32, inverse: f32) -> f32 {
    let t = clamp((v - start) * inverse, 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}

fn of_pixel(id: vec3u, v: vec4f, blurred: vec4f, wide: vec4f, given_clouds: vec4f, sheet: vec4f) -> vec4f {
    let q = (centre(id) + params.origin) * params.inverse_scale;
    var cloud = given_clouds.x;
    if params.given == 0u {
        cloud = 0.62 * value_noise(q * 0.009, 11u) + 0.38 * value_noise(q * 0.025, 503u);
    }
    let g = q * params.grain_frequency;
    var grain = 0.5 + 0.65 * (sheet.w - 0.5);
    var paper = sheet.rgb;
    if params.papered == 0u {
        grain = 0.6 * value_noise(g, 1013u) + 0.4 * value_noise(g * 2.3, 2027u);
        paper = vec3f(1.0);
    }

    // Detail counts against the light that is there.
    let tone = luma(v.rgb);
    let around = luma(wide.rgb);
    let detail = abs(around - tone) / (0.25 + around);
    let calm = 1.0 - rise(detail, 0.015, 22.0);
    let wet = params.bleeding * rise(cloud, 0.46, 6.0) * (1.0 - rise(detail, 0.04, 12.5));
    let color = v.rgb + wet * (wide.rgb - v.rgb);

    // Bare paper: in lights, at dark shapes where the brush was dry, and on peaks of the grain.
    let excess = luma(blurred.rgb) - tone;
    let darkness = 1.0 - luma(color);
    let gap = params.gaps * (1.0 - rise(cloud, 0.42, 6.0)) * rise(-excess, 0.035, 18.0) * rise(grain, 0.25, 4.0);
    let peak = params.dry * rise(grain + 0.6 * (0.36 - cloud), 0.7, 10.0);
    let bare = peak * calm * rise(darkness, 0.03, 14.0) * (1.0 - rise(darkness, 0.35, 3.3));
    let dark = darkness * darkness;
    let light = params.white * (1.0 - darkness) * (1.0 - darkness);
    let covered = dark / max(dark + light, 1e-6) * (1.0 - gap) * (1.0 - bare);

    // Density above that of the plain colour; thin paint cannot lose more than it has.
    let gathered = params.edges * (clamp(excess, 0.0, 0.1) + 0.05 * clamp(-excess, 0.0, 0.12)) * (1.0 - 0.8 * wet);
    let rim = 20.0 * (cloud - 0.66);
    let outside_rim = max(-rim, 0.0);
    let pushed = 0.5 * max(1.0 - 0.5 * outside_rim * outside_rim, 0.0);
    let water = rise(rim, -0.2, 1.4);
    let backrun = params.backruns * calm * (pushed * (1.0 - water) - water * (1.0 - 0.8 * rise(rim, 0.5, 0.28)));
    let uneven = params.clouds * (2.0 * cloud - 1.0) + params.grain * (2.0 * grain - 1.0);
    let density = max(0.55 + gathered + backrun + uneven, -0.7);

    // What is brighter than paper stays.
    let absorbed = 1.0 - color;
    let paint = 1.0 - covered * max(absorbed, vec3f(0.0));
    let dense = paint / (1.0 + density * clamp(1.0 - paint, vec3f(0.0), vec3f(1.0)));
    return vec4f(paper * (1.0 - params.pigment * (1.0 - dense) - min(absorbed, vec3f(0.0))), v.a);
}
