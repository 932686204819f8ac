// Motion as it enters: what is too long or no number is unknown.
// Cost: one load.
#import shared/motion

struct Params {
    /// Longest motion that counts, pixels.
    limit: f32,
}

@group(0) @binding(1) var<uniform> params: Params;
@group(0) @binding(2) var source: texture_2d<f32>;
@group(0) @binding(3) var target_image: texture_storage_2d<rg32float, write>;

fn of_pixel(id: vec3u, source: vec4f) -> vec4f {
    let motion = bounded_motion(source.xy, params.limit);
    return vec4f(motion, 0.0, 0.0);
}
