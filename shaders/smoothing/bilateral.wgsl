// The bilateral filter with an isotropic window (3.4), or one axis of its xy-separable form (§ 3.3);
// the range is measured as Euclidean distance of the three colour channels.
// Cost: one load and one exponential per pixel of the window, a disc of about 3.1 radius^2 or a line of
// 2 radius + 1 pixels.
#import grid

struct Params {
    // Pixels on each side of the centre, along x and along y; the larger one is the window's radius.
    extent: vec2i,
    // Exponents, base 2, per squared pixel of distance and per squared difference in range.
    domain: f32,
    range: f32,
}

@group(0) @binding(1) var<uniform> params: Params;
@group(0) @binding(2) var source: texture_2d<f32>;
@group(0) @binding(3) var target_image: texture_storage_2d<rgba32float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = pixel(id);
    let radius = max(params.extent.x, params.extent.y);
    let origin = fetch(source, 0u, p);
    // Of the differences to the centre, so that flat parts stay flat to the last bit.
    var sum = vec4f(0.0);
    for (var dy = -params.extent.y; dy <= params.extent.y; dy++) {
        for (var dx = -params.extent.x; dx <= params.extent.x; dx++) {
            let distance2 = dx * dx + dy * dy;
            if distance2 > radius * radius {
                continue;
            }
            let tap = fetch(source, 0u, p + vec2i(dx, dy));
            let d = tap.rgb - origin.rgb;
            let exponent = params.range * dot(d, d) + params.domain * f32(distance2);
            let weight = tap.a * exp2(max(exponent, -125.0));
            sum += weight * vec4f(d, 1.0);
        }
    }
    let moved = select(vec3f(0.0), sum.rgb / sum.a, sum.a > 1e-6);
    textureStore(target_image, vec2i(id.xy), vec4f(origin.rgb + moved, origin.a));
}
