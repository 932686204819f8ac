// Stretches contrast about middle grey and clamps to 0..1. Cost: one load, one multiply-add.
#import gpu/grid

struct Params {
    /// Factor on the distance to middle grey.
    gain: f32,
}

#params
#input source
#output target_image rgba32float

fn of_pixel(id: vec3u, v: vec4f) -> vec4f {
    let rgb = clamp((v.rgb - 0.5) * params.gain + 0.5, vec3f(0.0), vec3f(1.0));
    return vec4f(rgb, v.a);
}
