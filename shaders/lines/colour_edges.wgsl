// Differences of Gaussians of L, a and b as one: their length in CIELAB, with the sign of the darker side. Where
// lightness does not tell the sides apart, the greener and bluer one counts as the darker.
// Cost: three loads, two square roots and a division.
#import gpu/grid

struct Params {
    /// Weight of the colour axes against lightness.
    weight: f32,
}

#params
#input lightness, green_red, blue_yellow
#output target_image rg32float

fn of_pixel(id: vec3u, lightness: vec4f, green_red: vec4f, blue_yellow: vec4f) -> vec4f {
    let d = vec3f(lightness.x, params.weight * green_red.x, params.weight * blue_yellow.x);
    let chroma = d.y * d.y + d.z * d.z;
    let length = sqrt(d.x * d.x + chroma);
    // Both sides of an edge have a sign in full, and lines end where it changes.
    let side = clamp((3.0 * d.x + 0.8 * d.y + 0.6 * d.z) / (0.3 * sqrt(chroma) + 1e-6), -1.0, 1.0);
    return vec4f(d.x + side * (length - abs(d.x)), lightness.y, 0.0, 0.0);
}
