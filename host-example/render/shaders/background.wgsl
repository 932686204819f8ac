// The sky behind everything, as one triangle over the whole picture. Below the horizon it fades to a pale
// ground, against which dark and light objects both stand out.

struct Background {
    @builtin(position) clip: vec4f,
    @location(0) ray: vec3f,
}

fn behind_everything(index: u32) -> Background {
    let corner = vec2f(f32(index & 1u), f32(index >> 1u)) * 4.0 - 1.0;
    let view_ray = vec3f(corner * frame.sky_ray.xy, -1.0);
    // The inverse of a rotation is its transpose, hence the vector on the left.
    let ray = (vec4f(view_ray, 0.0) * frame.world_to_view).xyz;
    return Background(vec4f(corner, 0.0, 1.0), ray);
}

@vertex
fn background_vertex(@builtin(vertex_index) index: u32) -> Background {
    return behind_everything(index);
}

@fragment
fn background_fragment(in: Background) -> @location(0) vec4f {
    let y = normalize(in.ray).y;
    let above = mix(frame.horizon.rgb, frame.zenith.rgb, smoothstep(-0.05, 0.9, y));
    let below = mix(frame.horizon.rgb, frame.ground.rgb, 0.45);
    return vec4f(mix(above, below, smoothstep(0.1, -0.45, y)), 1.0);
}
