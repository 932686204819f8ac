// Lightness times edge image: the input of the next iteration of the flow-based difference of
// Gaussians, whose lines thus grow coherent.
// Cost: two loads and a multiplication.
#import gpu/grid

#input lightness, edges
#output target_image rg32float

fn of_pixel(id: vec3u, v: vec4f, edges: vec4f) -> vec4f {
    let edge = clamp(edges.x, 0.0, 1.0);
    return vec4f(v.x * edge, v.y, 0.0, 0.0);
}
