// The picture of a frame, on the window.

@group(0) @binding(0) var picture: texture_2d<f32>;

@vertex
fn present_vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return vec4f(vec2f(f32(index & 1u), f32(index >> 1u)) * 4.0 - 1.0, 0.0, 1.0);
}

fn encoded(light: vec3f) -> vec3f {
    let curve = 1.055 * pow(light, vec3f(1.0 / 2.4)) - 0.055;
    return select(curve, 12.92 * light, light <= vec3f(0.0031308));
}

fn decoded(value: vec3f) -> vec3f {
    let curve = pow((value + 0.055) / 1.055, vec3f(2.4));
    return select(curve, value / 12.92, value <= vec3f(0.04045));
}

@fragment
fn present_fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let texel = textureLoad(picture, vec2i(position.xy), 0);
    // Colours are light, and a single channel is grey as it is shown. Surfaces take one or the other.
    if IS_GREY {
        let grey = vec3f(clamp(texel.r, 0.0, 1.0));
        return vec4f(select(decoded(grey), grey, WANTS_ENCODED), 1.0);
    }
    let light = clamp(texel.rgb, vec3f(0.0), vec3f(1.0));
    return vec4f(select(light, encoded(light), WANTS_ENCODED), 1.0);
}
