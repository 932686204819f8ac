// Widths of lines by the distance from the camera: a factor from 1 near to another one far, of the nearest thing around, to
// which a line beside it belongs.
// Cost: 18 loads and about 60 operations.
#import gpu/grid

struct Params {
    /// Distance up to which lines keep their width, scene units.
    near: f32,
    /// Inverse of the way from there to where they have the other one, 1 / scene units.
    inverse_range: f32,
    /// Factor on widths far away, less 1.
    change: f32,
    /// Distance at which things are looked for, pixels.
    radius: f32,
    /// The factor at least.
    least: f32,
    /// 1: the field has a factor already.
    scaled: u32,
}

#params
// (E - G, F), or with a factor, and the distance, 0 or less where there is nothing.
#input field, depth
#output target_image rgba32float

const DIAGONAL: f32 = 0.70710678;
// Distance of what is nowhere.
const NOWHERE: f32 = 3.4e38;

fn distance_at(p: vec2i) -> f32 {
    let z = fetch(depth, 1u, p).x;
    // Compared by bits: shader compilers may assume that NaN and infinities do not exist.
    let is_there = (bitcast<u32>(z) & 0x7f800000u) != 0x7f800000u && z > 0.0;
    return select(NOWHERE, z, is_there);
}

// The nearest distance on a ring of eight pixels.
fn ring(p: vec2i, radius: f32) -> f32 {
    let straight = i32(ceil(radius));
    let slanted = i32(ceil(radius * DIAGONAL));
    var nearest = NOWHERE;
    for (var i = -1; i <= 1; i++) {
        for (var j = -1; j <= 1; j++) {
            let reach = select(straight, slanted, i != 0 && j != 0);
            nearest = min(nearest, distance_at(p + reach * vec2i(j, i)));
        }
    }
    return nearest;
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = pixel(id);
    let nearest = min(ring(p, params.radius), ring(p, 0.5 * params.radius));
    let share = clamp((nearest - params.near) * params.inverse_range, 0.0, 1.0);
    let own = fetch(field, 0u, p);
    let before = select(1.0, own.w, params.scaled != 0u);
    let factor = clamp(before * (1.0 + params.change * share), params.least, 4.0);
    textureStore(target_image, vec2i(id.xy), vec4f(own.xy, 0.0, factor));
}
