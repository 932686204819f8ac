// A picture of all directions behind everything: equirectangular, its middle where -Z is, its upper edge above.

@group(1) @binding(0) var environment: texture_2d<f32>;
@group(1) @binding(1) var bilinear: sampler;

@vertex
fn environment_vertex(@builtin(vertex_index) index: u32) -> Background {
    return behind_everything(index);
}

@fragment
fn environment_fragment(in: Background) -> @location(0) vec4f {
    let ray = normalize(in.ray);
    let around = atan2(ray.x, -ray.z) / 6.2831853;
    let down = acos(clamp(ray.y, -1.0, 1.0)) / 3.14159265;
    return vec4f(textureSampleLevel(environment, bilinear, vec2f(0.5 + around, down), 0.0).rgb, 1.0);
}
