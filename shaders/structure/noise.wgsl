// White noise by a hash of each grain's place in the full-size picture, grey and opaque: the mean of the
// grains that a pixel covers.
// Cost: about 15 integer operations a grain.
#import gpu/grid

struct Params {
    /// Grains per pixel, each way.
    pixel_size: f32,
    /// Pixels of the full-size picture per grain.
    grain: f32,
    /// Grains that a pixel can touch, each way.
    count: i32,
    /// Another number gives another noise.
    seed: u32,
    /// Where the picture stands in the canonical one, pixels.
    origin: vec2f,
}

#params
#output target_image rgba32float

fn mixed(v: u32) -> u32 {
    var h = v;
    h = (h ^ (h >> 16u)) * 0x7feb352du;
    h = (h ^ (h >> 15u)) * 0x846ca68bu;
    return h ^ (h >> 16u);
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let corner = vec2f(pixel(id)) + params.origin;
    let low = corner * params.pixel_size;
    let high = (corner + 1.0) * params.pixel_size;
    let first = floor(low);
    var sum = 0.0;
    for (var j = 0; j < params.count; j++) {
        let y = first.y + f32(j);
        let weight_y = max(min(high.y, y + 1.0) - max(low.y, y), 0.0);
        let row = mixed(u32(i32(floor(y * params.grain))) ^ params.seed);
        for (var i = 0; i < params.count; i++) {
            let x = first.x + f32(i);
            let weight_x = max(min(high.x, x + 1.0) - max(low.x, x), 0.0);
            let h = mixed(row + u32(i32(floor(x * params.grain))));
            // The upper 24 bits: every value is exact in a float.
            sum += f32(h >> 8u) / 16777216.0 * (weight_y * weight_x);
        }
    }
    let size = high - low;
    let value = sum / (size.y * size.x);
    textureStore(target_image, vec2i(id.xy), vec4f(vec3f(value), 1.0));
}
