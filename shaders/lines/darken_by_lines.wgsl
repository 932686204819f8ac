// Lightness times edge image: the input of the next iteration of the flow-based difference of
// Gaussians, whose lines thus grow coherent.
// Cost: two loads and a multiplication.
#import gpu/grid

@group(0) @binding(2) var lightness: texture_2d<f32>;
@group(0) @binding(3) var edges: texture_2d<f32>;
@group(0) @binding(4) var target_image: texture_storage_2d<rg32float, write>;

fn of_pixel(id: vec3u, v: vec4f, edges: vec4f) -> vec4f {
    let edge = clamp(edges.x, 0.0, 1.0);
    return vec4f(v.x * edge, v.y, 0.0, 0.0);
}
