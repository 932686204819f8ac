// The minimum or maximum of the gradient-directed shock filter (Listing 6.2): the pixel along the major
// eigenvector whose luma is least or greatest, chosen by the sign of a second derivative.
// Cost: at most four loads per step.
#import grid
#import tensor

struct Params {
    // Distance of the last pixel looked at, pixels of the full-size picture.
    radius: f32,
    // Pixels per pixel of the full-size picture.
    scale: f32,
    // Responses up to this leave a pixel alone.
    threshold: f32,
}

@group(0) @binding(1) var<uniform> params: Params;
@group(0) @binding(2) var source: texture_2d<f32>;
@group(0) @binding(3) var tensors: texture_2d<f32>;
@group(0) @binding(4) var response: texture_2d<f32>;
@group(0) @binding(5) var target_image: texture_storage_2d<rgba32float, write>;

fn luma(v: vec4f) -> f32 {
    return dot(v.rgb, vec3f(0.2126, 0.7152, 0.0722));
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = pixel(id);
    let origin = fetch(source, 0u, p);
    let z = fetch(response, 2u, p).x;
    var best = origin;
    if abs(z) > params.threshold {
        // Above the threshold lies the zone of a minimum: erode. Below its opposite: dilate.
        let sign = select(1.0, -1.0, z > 0.0);
        let tensor = fetch(tensors, 1u, p);
        let n = tensor_axis((tensor.x - tensor.z) * 0.5, tensor.y).major;
        let along_x = abs(n.x) > abs(n.y);
        let major = select(n.y, n.x, along_x);
        let slope = select(n.x, n.y, along_x) / major;
        let wanted = floor((params.radius + 1e-3) * abs(major)) * params.scale;
        let steps = i32(ceil(wanted));
        var extreme = sign * luma(origin);
        var whole = best;
        for (var k = 1; k <= steps; k++) {
            if f32(k) > wanted {
                // The last step counts by its share.
                whole = best;
            }
            for (var side = 1; side >= -1; side -= 2) {
                let across = f32(side * k) * slope;
                for (var next = 0.999; next > 0.0; next -= 0.998) {
                    // The pixels on both sides of the line; one and the same where it meets a centre.
                    let i = i32(floor(across + next));
                    let v = fetch(source, 0u, p + select(vec2i(i, side * k), vec2i(side * k, i), along_x));
                    let value = sign * luma(v);
                    // A pixel much less covered than this one knows little of its own colour.
                    if value > extreme && v.a >= 0.5 * origin.a {
                        extreme = value;
                        best = v;
                    }
                }
            }
        }
        if f32(steps) > wanted {
            best = whole + (best - whole) * (wanted - floor(wanted));
        }
    }
    textureStore(target_image, vec2i(id.xy), vec4f(best.rgb, origin.a));
}
