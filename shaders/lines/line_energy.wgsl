// Energy of lines as a tensor: how far the response falls below its ground, across the orientation that lines have
// there. Averages of it tell how many lines are around, how strong, and how they lie.
// Cost: three loads and 30 operations.
#import gpu/grid
#import shared/tensor
#import shared/coverage

struct Params {
    /// Weight of the lightness in the response.
    base: f32,
    /// Lightness that counts at least, units of L.
    least: f32,
    /// Most that a pixel counts, in units of the response.
    most: f32,
}

#params
// (u alpha, alpha), (L alpha, alpha), (E - G, F).
#input response, lightness, field
#output target_image rgba32float

fn of_pixel(id: vec3u, response: vec4f, lightness: vec4f, field: vec4f) -> vec4f {
    let ground = params.base * max(lightness.x, params.least * lightness.y);
    let energy = clamp(ground - response.x, 0.0, params.most);
    let across = tensor_axis(0.5 * field.x, field.y).major;
    let e = energy * across;
    return vec4f(e.x * across.x, e.x * across.y, e.y * across.y, 1.0);
}
