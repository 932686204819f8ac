// Thin paint on paper: pigment that gathers at the borders of dark regions, in clouds and in the grain
// of the paper (Bousseau et al. 2006). Clouds and grain belong to the full-size picture, so that tiles
// and proxies show the same paper.
// Cost: three loads, 16 hashes and about 150 multiply-adds.
#import shared/value_noise
#import gpu/grid

struct Params {
    /// Pixels of the full-size picture per pixel.
    inverse_scale: f32,
    /// How much pigment there is: 1 leaves the colours alone.
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
    /// Nonzero: clouds are those of the third image.
    given: u32,
}

#params
#input source, blurred, given_clouds
#output target_image rgba32float

// Luma within the range of paper.
fn luma(c: vec3f) -> f32 {
    return clamp(dot(c, vec3f(0.2126, 0.7152, 0.0722)), 0.0, 1.0);
}

fn of_pixel(id: vec3u, v: vec4f, blurred: vec4f, given_clouds: vec4f) -> vec4f {
    let q = (centre(id) + params.origin) * params.inverse_scale;
    var cloud = given_clouds.x;
    if params.given == 0u {
        cloud = 0.6 * value_noise(q * 0.017, 11u) + 0.4 * value_noise(q * 0.043, 503u);
    }
    let g = q * params.grain_frequency;
    let grain = 0.6 * value_noise(g, 1013u) + 0.4 * value_noise(g * 2.3, 2027u);
    let excess = luma(blurred.rgb) - luma(v.rgb);
    let gathered = params.edges * (max(excess, 0.0) + 0.25 * max(-excess, 0.0));
    let density = gathered + params.clouds * (2.0 * cloud - 1.0) + params.grain * (2.0 * grain - 1.0);
    let thin = 1.0 - params.pigment * (1.0 - v.rgb);
    // Neither paper nor the darkest pigment changes, nor what is brighter than paper.
    let color = thin - density * max(thin - thin * thin, vec3f(0.0));
    return vec4f(color, v.a);
}
