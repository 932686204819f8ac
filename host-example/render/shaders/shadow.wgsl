// Depth of the scene as the sun sees it.

struct Cascade {
    index: vec4u,
}

@group(3) @binding(0) var<uniform> cascade: Cascade;

struct ShadowInput {
    @builtin(position) clip: vec4f,
    @location(0) uv0: vec2f,
    @location(1) uv1: vec2f,
    @location(2) alpha: f32,
}

@vertex
fn shadow_vertex(in: VertexInput) -> ShadowInput {
    let position = current_position(in, current_matrix(in));
    return ShadowInput(frame.sun_matrices[cascade.index.x] * vec4f(position, 1.0), in.uv0, in.uv1, in.color.a);
}

// Only for materials with holes or blending, which cast a shadow where they are more than half there.
@fragment
fn shadow_fragment(in: ShadowInput) {
    if base_color(in.uv0, in.uv1, vec4f(1.0, 1.0, 1.0, in.alpha)).a < material.alpha_cutoff {
        discard;
    }
}
