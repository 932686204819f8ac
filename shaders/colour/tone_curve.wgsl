// Raises or lowers the dark and the light tones of a Lab image; black, white and what lies beyond
// them stay.
// Cost: one load and ten multiply-adds.
#import gpu/grid

struct Params {
    /// How far dark tones are raised, -1..=1.
    darks: f32,
    /// How far light tones are raised, -1..=1.
    lights: f32,
}

#params
#input source
#output target_image rgba32float

fn of_pixel(id: vec3u, v: vec4f) -> vec4f {
    let t = clamp(v.x * 0.01, 0.0, 1.0);
    let hump = t * (1.0 - t);
    // The factor keeps every slope at 0.1 or more, so that tones never change order.
    let lift = 90.0 * hump * (params.darks * (1.0 - t) + params.lights * t);
    return vec4f(v.x + lift, v.yzw);
}
