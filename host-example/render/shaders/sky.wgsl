// The surroundings: a gradient from the ground over the horizon to the zenith, without any texture. It
// lights diffuse surfaces, unless a picture of the surroundings does, and is mirrored by glossy ones.

// Radiance from a direction; blur 0 is the sky itself, 1 its mean over most of a hemisphere.
fn sky(direction: vec3f, blur: f32) -> vec3f {
    let y = direction.y;
    let above = mix(frame.horizon.rgb, frame.zenith.rgb, pow(clamp(y, 0.0, 1.0), 0.7));
    let below = mix(0.8 * frame.horizon.rgb, frame.ground.rgb, clamp(-2.5 * y, 0.0, 1.0));
    let width = mix(0.25, 1.0, blur);
    return mix(below, above, smoothstep(-width, width, y));
}

// Light that falls on a diffuse surface, divided by pi.
fn sky_irradiance(normal: vec3f) -> vec3f {
    if frame.irradiance[0].w > 0.5 {
        let n = normal;
        let sum = frame.irradiance[0] + frame.irradiance[1] * n.y + frame.irradiance[2] * n.z
            + frame.irradiance[3] * n.x + frame.irradiance[4] * n.x * n.y + frame.irradiance[5] * n.y * n.z
            + frame.irradiance[6] * (3.0 * n.z * n.z - 1.0) + frame.irradiance[7] * n.z * n.x
            + frame.irradiance[8] * (n.x * n.x - n.y * n.y);
        return max(sum.rgb, vec3f(0.0));
    }
    let upper = 0.5 * (frame.zenith.rgb + frame.horizon.rgb);
    let lower = 0.5 * (frame.ground.rgb + 0.6 * frame.horizon.rgb);
    return mix(lower, upper, 0.5 + 0.5 * normal.y);
}

// A wide soft light of one direction, mirrored by surfaces of this roughness; keeps its energy when it widens.
fn soft_box(direction: vec3f, axis: vec3f, blur: f32) -> f32 {
    let sharpness = mix(24.0, 1.5, sqrt(blur));
    return (sharpness + 1.0) / 25.0 * exp(sharpness * (dot(direction, axis) - 1.0));
}

// What a glossy surface mirrors: the sky and two soft boxes, one beside the sun and one facing it, which
// give metals their shape.
fn mirrored(direction: vec3f, roughness: f32) -> vec3f {
    let key = normalize(frame.sun_direction.xyz + vec3f(0.0, 0.35, 0.0));
    let side = normalize(vec3f(-frame.sun_direction.z, 0.25, frame.sun_direction.x));
    let rim = normalize(vec3f(-frame.sun_direction.x, 0.5, -frame.sun_direction.z));
    let boxes = 1.1 * soft_box(direction, key, roughness) + 0.7 * soft_box(direction, side, roughness)
        + 0.5 * soft_box(direction, rim, roughness);
    return sky(direction, roughness) + boxes * frame.horizon.rgb;
}
