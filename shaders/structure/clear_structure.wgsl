// Share of what is around a pixel that is clear structure, in place of texture and blur, and its weight.
// Cost: two loads, a square root and two divisions.
#import gpu/grid

struct Params {
    /// Factor on the energy of coarse gradients, per pixel of the fine ones.
    area: f32,
    /// Factor on the ratio of both energies, which makes it 1 for a sharp edge that stands alone.
    ratio: f32,
    /// Gradient that counts half.
    half_gradient: f32,
}

#params
// Mean tensors (E, F, G, w) of gradients of fine pixels and of pixels of this level.
#input fine, coarse
#output target_image rgba32float

// Ratios between which texture becomes structure, and between which structure becomes blur.
const TEXTURE: vec2f = vec2f(0.2, 0.65);
const BLUR: vec2f = vec2f(1.6, 2.8);

// Energy that counts at most: that of highlights may be infinite.
const MOST: f32 = 1e6;

fn clear_ramp(ends: vec2f, x: f32) -> f32 {
    let t = clamp((x - ends.x) / (ends.y - ends.x), 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}

fn of_pixel(id: vec3u, fine: vec4f, coarse: vec4f) -> vec4f {
    let energy = clamp(coarse.x + coarse.z, 0.0, MOST) * params.area;
    let all = clamp(fine.x + fine.z, 0.0, MOST);
    let ratio = params.ratio * energy / (all + 1e-9);
    let gradient = sqrt(energy);
    let weight = gradient / (gradient + params.half_gradient);
    let clear = clear_ramp(TEXTURE, ratio) * (1.0 - clear_ramp(BLUR, ratio));
    return vec4f(weight * clear, weight, 0.0, 1.0);
}
