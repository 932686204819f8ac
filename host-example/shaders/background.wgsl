// The sky behind everything, as one triangle over the whole picture.

struct Background {
    @builtin(position) clip: vec4f,
    @location(0) ray: vec3f,
}

@vertex
fn background_vertex(@builtin(vertex_index) index: u32) -> Background {
    let corner = vec2f(f32(index & 1u), f32(index >> 1u)) * 4.0 - 1.0;
    let view_ray = vec3f(corner * frame.sky_ray.xy, -1.0);
    // The inverse of a rotation is its transpose, hence the vector on the left.
    let ray = (vec4f(view_ray, 0.0) * frame.world_to_view).xyz;
    return Background(vec4f(corner, 0.0, 1.0), ray);
}

@fragment
fn background_fragment(in: Background) -> @location(0) vec4f {
    return vec4f(sky(normalize(in.ray), 0.6), 1.0);
}
