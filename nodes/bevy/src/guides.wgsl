// The prepasses of a camera as the guides of a look, in the camera's viewport. The types of the prepasses' textures, which may be
// multisampled, are named before this text.

struct View {
    view_from_world: mat4x4f,
    view_from_clip: mat4x4f,
    // In the target, in pixels: left, top, width and height.
    viewport: vec4i,
}

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var colors: texture_2d<f32>;
@group(0) @binding(2) var depths: Depths;
@group(0) @binding(3) var normals: Vectors;
@group(0) @binding(4) var motions: Vectors;
@group(0) @binding(5) var color: texture_storage_2d<rgba16float, write>;
@group(0) @binding(6) var normal: texture_storage_2d<rgba16float, write>;
@group(0) @binding(7) var depth: texture_storage_2d<r32float, write>;
@group(0) @binding(8) var motion: texture_storage_2d<rg32float, write>;

@compute @workgroup_size(8, 8)
fn write_guides(@builtin(global_invocation_id) id: vec3u) {
    let place = vec2i(id.xy);
    let size = view.viewport.zw;
    if any(place >= size) {
        return;
    }
    let texel = place + view.viewport.xy;
    textureStore(color, place, textureLoad(colors, texel, 0));
    // The first sample of several: an edge has one side.
    let z = textureLoad(depths, texel, 0);
    var distance = 0.0;
    var facing = vec3f(0.0);
    // Depth is reversed, and 0 where nothing was drawn.
    if z > 0.0 {
        let uv = (vec2f(place) + 0.5) / vec2f(size);
        let point = view.view_from_clip * vec4f(uv * vec2f(2.0, -2.0) + vec2f(-1.0, 1.0), z, 1.0);
        distance = -point.z / point.w;
        let world = textureLoad(normals, texel, 0).xyz * 2.0 - 1.0;
        let turned = (view.view_from_world * vec4f(world, 0.0)).xyz;
        facing = turned / max(length(turned), 1e-6);
    }
    textureStore(normal, place, vec4f(facing, 1.0));
    textureStore(depth, place, vec4f(distance, 0.0, 0.0, 1.0));
    // From where points were, in widths and heights, to where they are; looks ask for the way back, in pixels.
    let moved = textureLoad(motions, texel, 0).xy * vec2f(size);
    textureStore(motion, place, vec4f(-moved, 0.0, 1.0));
}
