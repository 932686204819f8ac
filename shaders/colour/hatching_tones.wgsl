// Tones of hatching that a host gives: the share of each pixel that ink covers, a channel each. What is no number is paper.
// Cost: one load, four comparisons and four subtractions.
#import gpu/grid

#input hatching
#output target_image rgba32float

fn of_pixel(id: vec3u, hatching: vec4f) -> vec4f {
    // Compared by bits: shader compilers may assume that NaN does not exist.
    let is_number = (bitcast<vec4u>(hatching) & vec4u(0x7fffffffu)) <= vec4u(0x7f800000u);
    let white = vec4f(1.0);
    return white - select(white, clamp(hatching, vec4f(0.0), white), is_number);
}
