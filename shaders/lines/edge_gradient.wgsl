// First and second derivatives of the lightness of a smoothed Lab image (section 4.1, 4.2.1): gx, gy, the
// gradient's magnitude as the height of the step that would have it, and the Laplacian.
// Where a neighbour is transparent it counts as the pixel itself.
// Cost: nine loads and about 40 operations.
#import gpu/grid

struct Params {
    /// Weight across the derivative of the pixel's own row or column.
    centre: f32,
    /// Weight of each of the two beside it.
    side: f32,
    /// From L per pixel to the height of a step.
    scale: f32,
}

#params
#input source
#output target_image rgba32float

// How far the lightness at p is above `own`, as far as the pixel is covered.
fn rise(p: vec2i, own: f32) -> f32 {
    let v = fetch(source, 0u, p);
    return (v.x - own) * v.w;
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = pixel(id);
    let v = fetch(source, 0u, p);
    let nw = rise(p + vec2i(-1, -1), v.x);
    let n = rise(p + vec2i(0, -1), v.x);
    let ne = rise(p + vec2i(1, -1), v.x);
    let w = rise(p + vec2i(-1, 0), v.x);
    let e = rise(p + vec2i(1, 0), v.x);
    let sw = rise(p + vec2i(-1, 1), v.x);
    let s = rise(p + vec2i(0, 1), v.x);
    let se = rise(p + vec2i(1, 1), v.x);
    let gx = 0.5 * (params.centre * (e - w) + params.side * ((ne - nw) + (se - sw)));
    let gy = 0.5 * (params.centre * (s - n) + params.side * ((sw - nw) + (se - ne)));
    let height = sqrt(gx * gx + gy * gy) * params.scale * v.w;
    let laplacian = ((n + s) + (e + w)) * 0.6666667 + ((nw + ne) + (sw + se)) * 0.16666667;
    textureStore(target_image, vec2i(id.xy), vec4f(gx, gy, height, laplacian));
}
