// Depth of the nearest point among those beside a pixel in its row, and by how many columns it lies to the right.
// Cost: 2 reach + 1 loads.
#import gpu/grid
#import shared/breaks

struct Params {
    /// Pixels to both sides.
    reach: u32,
}

#params
#input depth
#output target_image rg32float

// Depth of what is not there.
const FAR: f32 = 3e38;

fn depth_at(p: vec2i) -> f32 {
    let z = known_depth(fetch(depth, 0u, p).x);
    return select(z, FAR, z <= 0.0);
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = pixel(id);
    var nearest = vec2f(depth_at(p), 0.0);
    for (var by = 1; by <= i32(params.reach); by++) {
        for (var side = -1; side <= 1; side += 2) {
            let z = depth_at(p + vec2i(side * by, 0));
            if z < nearest.x {
                nearest = vec2f(z, f32(side * by));
            }
        }
    }
    textureStore(target_image, vec2i(id.xy), vec4f(nearest, 0.0, 1.0));
}
