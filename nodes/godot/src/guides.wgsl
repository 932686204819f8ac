// Godot's pictures of a viewport as the guides of a look.

struct View {
    view_from_clip: mat4x4f,
    // Width and height of the viewport.
    size: vec2i,
    has_normals: u32,
    has_velocities: u32,
    is_transparent: vec4u,
}

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(2) var colors: texture_2d<f32>;
@group(0) @binding(3) var depths: texture_2d<f32>;
@group(0) @binding(4) var normals: texture_2d<f32>;
@group(0) @binding(5) var velocities: texture_2d<f32>;
@group(0) @binding(6) var color: texture_storage_2d<rgba16float, write>;
@group(0) @binding(7) var normal: texture_storage_2d<rgba16float, write>;
@group(0) @binding(8) var depth: texture_storage_2d<r32float, write>;
@group(0) @binding(9) var motion: texture_storage_2d<rg32float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let place = vec2i(id.xy);
    if any(place >= view.size) {
        return;
    }
    // Without a transparent background alpha is no coverage, and 0 behind things.
    let plain = textureLoad(colors, place, 0);
    textureStore(color, place, vec4f(plain.rgb, select(1.0, plain.a, view.is_transparent.x != 0u)));
    let z = textureLoad(depths, place, 0).x;
    var distance = 0.0;
    var facing = vec3f(0.0);
    // Depth is reversed, and 0 where nothing was drawn.
    if z > 0.0 {
        let uv = (vec2f(place) + 0.5) / vec2f(view.size);
        let point = view.view_from_clip * vec4f(uv * 2.0 - 1.0, z, 1.0);
        distance = -point.z / point.w;
        let stored = textureLoad(normals, place, 0).xyz * 2.0 - 1.0;
        facing = select(vec3f(0.0), stored / max(length(stored), 1e-6), view.has_normals != 0u);
    }
    textureStore(normal, place, vec4f(facing, 1.0));
    textureStore(depth, place, vec4f(distance, 0.0, 0.0, 1.0));
    // From where points are to where they were, in widths and heights.
    var moved = vec2f(0.0);
    if view.has_velocities != 0u {
        moved = textureLoad(velocities, place, 0).xy * vec2f(view.size);
    }
    textureStore(motion, place, vec4f(moved, 0.0, 1.0));
}
