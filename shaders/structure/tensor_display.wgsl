// A tensor field as a colour: orientation on the circle of double angles, or anisotropy as grey.
// Cost: one load and about 30 operations.
#import grid
#import tensor

struct Params {
    // 0 orientation, 1 anisotropy.
    show: u32,
}

@group(0) @binding(1) var<uniform> params: Params;
@group(0) @binding(2) var source: texture_2d<f32>;
@group(0) @binding(3) var target_image: texture_storage_2d<rgba32float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let t = fetch(source, 0u, pixel(id));
    var color = vec3f(tensor_anisotropy(t));
    if params.show == 0u {
        // Anisotropy times (cos 2 phi, sin 2 phi), phi the angle of the tangent.
        let trace = max(t.x + t.z, TENSOR_SMALLEST);
        let axis = vec2f(t.z - t.x, -2.0 * t.y) / trace;
        color = vec3f(
            0.5 + 0.5 * axis.x,
            0.5 - 0.25 * axis.x + 0.4330127 * axis.y,
            0.5 - 0.25 * axis.x - 0.4330127 * axis.y,
        );
    }
    textureStore(target_image, vec2i(id.xy), vec4f(color, 1.0));
}
