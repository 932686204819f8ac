// What orientation needs of a tensor, (E - G, F): both are linear, so that interpolation commutes, and
// stream lines load half as much. Read as a tensor whose G is 0 it has the same eigenvectors.
// Cost: one load.
#import gpu/grid

#input tensor
#output target_image rg32float

fn of_pixel(id: vec3u, t: vec4f) -> vec4f {
    return vec4f(t.x - t.z, t.y, 0.0, 0.0);
}
