// Importance of places of a picture, 0..1: as far as structure is clear around them, and near the middle.
// Cost: a load, an exponential and a division.
#import gpu/grid

struct Params {
    /// Middle of the picture, pixels.
    middle: vec2f,
    /// Of a Gaussian around it: -1 / (2 sigma^2), per square pixel.
    falloff: f32,
    /// Share of it, 0..1.
    centre: f32,
}

#params
// (weight share, weight) around each pixel.
#input found
#output target_image r32float

// Weight of places without structure, and how clear they count.
const EMPTY: f32 = 0.03;
const CLEAR_WHEN_EMPTY: f32 = 0.35;

fn of_pixel(id: vec3u, found: vec4f) -> vec4f {
    let share = (found.x + EMPTY * CLEAR_WHEN_EMPTY) / (found.y + EMPTY);
    let d = centre(id) - params.middle;
    let near = 1.0 + params.centre * (exp(params.falloff * dot(d, d)) - 1.0);
    return vec4f(clamp(share, 0.0, 1.0) * near, 0.0, 0.0, 0.0);
}
