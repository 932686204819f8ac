// A finished picture on the window: pixel for pixel, encoded where the surface does not do it itself.

struct Settings {
    // Bit 0: the picture is one channel of grey, already encoded for a display.
    // Bit 1: the surface stores what it is given, so that light must be encoded here.
    flags: vec4u,
}

@group(0) @binding(0) var picture: texture_2d<f32>;
@group(0) @binding(1) var<uniform> settings: Settings;

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
    let last = textureDimensions(picture) - 1u;
    let texel = textureLoad(picture, min(vec2u(position.xy), last), 0);
    let grey = (settings.flags.x & 1u) != 0u;
    let encode = (settings.flags.x & 2u) != 0u;
    let value = clamp(select(texel.rgb, texel.rrr, grey), vec3f(0.0), vec3f(1.0));
    if grey {
        return vec4f(select(decoded(value), value, encode), 1.0);
    }
    return vec4f(select(value, encoded(value), encode), 1.0);
}
