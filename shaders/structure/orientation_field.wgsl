// What orientation needs of a tensor, (E - G, F): both are linear, so that interpolation commutes, and
// stream lines load half as much. Read as a tensor whose G is 0 it has the same eigenvectors.
// Cost: one load.
#import gpu/grid

@group(0) @binding(2) var tensor: texture_2d<f32>;
@group(0) @binding(3) var target_image: texture_storage_2d<rg32float, write>;

fn of_pixel(id: vec3u, t: vec4f) -> vec4f {
    return vec4f(t.x - t.z, t.y, 0.0, 0.0);
}
