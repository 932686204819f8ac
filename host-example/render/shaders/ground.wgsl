// The ground below a scene, as far as shadows may fall on it.

struct Ground {
    @builtin(position) clip: vec4f,
    @location(0) position: vec3f,
}

@vertex
fn ground_vertex(@builtin(vertex_index) index: u32) -> Ground {
    let corner = vec2f(f32(index & 1u), f32(index >> 1u));
    let place = mix(frame.ground_low.xz, frame.ground_high.xz, corner);
    let position = vec3f(place.x, frame.ground_low.y, place.y);
    return Ground(frame.view_projection * vec4f(position, 1.0), position);
}

// Points spread evenly over the unit disc, on a spiral of golden angles.
fn spiral(index: u32, count: u32) -> vec2f {
    let angle = 2.3999632 * f32(index);
    return sqrt((f32(index) + 0.5) / f32(count)) * vec2f(cos(angle), sin(angle));
}
