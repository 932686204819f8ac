// Motion as it enters: what is too long or no number is unknown.
// Cost: one load.
#import shared/motion

struct Params {
    /// Longest motion that counts, pixels.
    limit: f32,
}

#params
#input source
#output target_image rg32float

fn of_pixel(id: vec3u, source: vec4f) -> vec4f {
    let motion = bounded_motion(source.xy, params.limit);
    return vec4f(motion, 0.0, 0.0);
}
