// Lines as strong as a map of opacities lets them be.
// Cost: two loads.
#import gpu/grid

#input edges
// The opacity in alpha.
#input opacity
#output target_image r32float

fn of_pixel(id: vec3u, edges: vec4f, opacity: vec4f) -> vec4f {
    return vec4f(1.0 - (1.0 - clamp(edges.x, 0.0, 1.0)) * clamp(opacity.a, 0.0, 1.0), 0.0, 0.0, 0.0);
}
