// What the renderer knows about each pixel beside its colour, at the pixel's centre.

// 1 where parts of the surface may be absent.
override CUTOUT: u32 = 0u;

struct GeometryInput {
    @builtin(position) clip: vec4f,
    @location(0) normal: vec3f,
    @location(1) depth: f32,
    @location(2) now: vec3f,
    @location(3) before: vec3f,
    @location(4) uv0: vec2f,
    @location(5) uv1: vec2f,
    @location(6) alpha: f32,
    @location(7) @interpolate(flat) object_id: u32,
}

struct GeometryOutput {
    // Unit normal of the surface, without its normal map, in camera space; w is 1.
    @location(0) normal: vec4f,
    // Distance along the view axis.
    @location(1) depth: f32,
    @location(2) object_id: f32,
    // In pixels, x to the right and y down: where this point was one frame ago, minus where it is.
    @location(3) motion: vec2f,
}

@vertex
fn geometry_vertex(in: VertexInput) -> GeometryInput {
    let matrix = current_matrix(in);
    let position = vec4f(current_position(in, matrix), 1.0);
    let local_normal = morphed(in.normal, in.instance, in.vertex, instances[in.instance].weights, 1u);
    let normal = transform_normal(matrix, local_normal);
    var out: GeometryInput;
    out.clip = frame.view_projection * position;
    out.normal = (frame.world_to_view * vec4f(normal, 0.0)).xyz;
    out.depth = -(frame.world_to_view * position).z;
    out.now = out.clip.xyw;
    out.before = (frame.previous_view_projection * vec4f(previous_position(in), 1.0)).xyw;
    out.uv0 = in.uv0;
    out.uv1 = in.uv1;
    out.alpha = in.color.a;
    out.object_id = instances[in.instance].object_id;
    return out;
}

@fragment
fn geometry_fragment(in: GeometryInput, @builtin(front_facing) front: bool) -> GeometryOutput {
    if CUTOUT == 1u {
        let alpha = base_color(in.uv0, in.uv1, vec4f(1.0, 1.0, 1.0, in.alpha)).a;
        if alpha < material.alpha_cutoff {
            discard;
        }
    }
    // A point that was behind the camera has no place in the previous picture.
    let before = select(in.now.xy / in.now.z, in.before.xy / in.before.z, in.before.z > 0.0);
    let motion = (before - in.now.xy / in.now.z) * vec2f(0.5, -0.5) * frame.size.xy;
    let normal = safe_normalize(in.normal) * select(-1.0, 1.0, front);
    return GeometryOutput(vec4f(normal, 1.0), in.depth, f32(in.object_id), motion);
}

struct RestInput {
    @builtin(position) clip: vec4f,
    @location(0) rest: vec3f,
    @location(1) uv0: vec2f,
    @location(2) uv1: vec2f,
    @location(3) alpha: f32,
}

// Where each point is before anything moves, without morph targets; a pass of its own, since few frames need it.
@vertex
fn rest_vertex(in: VertexInput) -> RestInput {
    let position = vec4f(current_position(in, current_matrix(in)), 1.0);
    let rest = (instances[in.instance].rest * vec4f(in.position, 1.0)).xyz;
    return RestInput(frame.view_projection * position, rest, in.uv0, in.uv1, in.color.a);
}

@fragment
fn rest_fragment(in: RestInput) -> @location(0) vec4f {
    if CUTOUT == 1u && base_color(in.uv0, in.uv1, vec4f(1.0, 1.0, 1.0, in.alpha)).a < material.alpha_cutoff {
        discard;
    }
    return vec4f(in.rest, 1.0);
}

// Values of the control map at the vertices of a primitive; where it has none, a single one that changes nothing.
@group(3) @binding(0) var<storage, read> control_values: array<vec4f>;

struct ControlInput {
    @builtin(position) clip: vec4f,
    @location(0) control: vec4f,
    @location(1) uv0: vec2f,
    @location(2) uv1: vec2f,
    @location(3) alpha: f32,
}

// What an artist painted on surfaces, for styles; a pass of its own, since few scenes have it.
@vertex
fn control_vertex(in: VertexInput) -> ControlInput {
    let position = vec4f(current_position(in, current_matrix(in)), 1.0);
    let control = control_values[min(in.vertex, arrayLength(&control_values) - 1u)];
    return ControlInput(frame.view_projection * position, control, in.uv0, in.uv1, in.color.a);
}

@fragment
fn control_fragment(in: ControlInput) -> @location(0) vec4f {
    if CUTOUT == 1u && base_color(in.uv0, in.uv1, vec4f(1.0, 1.0, 1.0, in.alpha)).a < material.alpha_cutoff {
        discard;
    }
    return in.control;
}
