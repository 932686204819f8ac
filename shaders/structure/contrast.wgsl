// Stretches contrast about middle grey and clamps to 0..1. Cost: one load, one multiply-add.
#import gpu/grid

struct Params {
    /// Factor on the distance to middle grey.
    gain: f32,
}

@group(0) @binding(1) var<uniform> params: Params;
@group(0) @binding(2) var source: texture_2d<f32>;
@group(0) @binding(3) var target_image: texture_storage_2d<rgba32float, write>;

fn of_pixel(id: vec3u, v: vec4f) -> vec4f {
    let rgb = clamp((v.rgb - 0.5) * params.gain + 0.5, vec3f(0.0), vec3f(1.0));
    return vec4f(rgb, v.a);
}
