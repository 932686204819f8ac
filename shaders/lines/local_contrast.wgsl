// Response of a difference of Gaussians against the local deviation of its source, so that soft light draws lines
// and hard light is not black: divisive normalisation of contrast (Heeger 1992).
// Cost: three loads, a square root and a division.
#import gpu/grid
#import shared/coverage

struct Params {
    /// Weight of the lightness in the response.
    base: f32,
    /// Lightness that counts at least, units of L: below it no weaker edges draw lines.
    least: f32,
    /// How far the deviation counts, 0..1.
    amount: f32,
    /// Strength of a response where nothing deviates, times the floor.
    strength: f32,
    /// Square of the share of the deviation.
    share: f32,
    /// Square of the floor, units of L.
    floor: f32,
}

#params
// (u alpha, alpha) without lightness, (L alpha, alpha), moments of the surroundings (L alpha, L^2 alpha, alpha).
#input response, lightness, moments
#output target_image rg32float

fn of_pixel(id: vec3u, response: vec4f, lightness: vec4f, moments: vec4f) -> vec4f {
    let inverse = 1.0 / max(moments.z, LEAST_COVERAGE);
    let mean = moments.x * inverse;
    let variance = max(moments.y * inverse - mean * mean, 0.0);
    let gain = params.strength / sqrt(params.share * variance + params.floor);
    let factor = 1.0 + params.amount * (gain - 1.0);
    let ground = params.base * max(lightness.x, params.least * lightness.y);
    return vec4f(ground + response.x * factor, response.y, 0.0, 0.0);
}
