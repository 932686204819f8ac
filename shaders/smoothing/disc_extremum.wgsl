// The greatest or least value of each channel within a disc: dilation or erosion (§ 5.1).
// Cost: one read of workgroup memory and one comparison per pixel of the disc, about 3.1 (radius + 1/2)^2;
// radius^2 / 16 + radius / 2 + 1 loads and, where discs go in parts, about as many again.
#import gpu/window

struct Params {
    /// Rows on each side of the centre.
    extent: i32,
    /// Pixels of the disc lie at most the square root of this away.
    limit: i32,
    /// 1: greatest; -1: least.
    sign: f32,
}

#params
#input source
#output target_image rgba32float

// Below every value.
const LOWEST: f32 = -3.40282346e38;

const WINDOW_PIXELS: i32 = WINDOW_AREA;

fn window_tap(p: vec2i) -> vec4f {
    return fetch(source, 0u, p);
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    let p = group_pixel(id);
    let origin = fetch(source, 0u, p);
    // Loops take no parameter from memory that they can hold.
    let sign = params.sign;
    let limit = params.limit;
    var best = vec3f(LOWEST);
    var seen = false;
    let step = window_step(vec2i(2 * params.extent + 1));
    for (var y = -params.extent; y <= params.extent; y += step.y) {
        for (var x = -params.extent; x <= params.extent; x += step.x) {
            let last = min(vec2i(x, y) + step - 1, vec2i(params.extent));
            let part = window_load(id, vec2i(x, y), last);
            for (var dy = y; dy <= last.y; dy++) {
                let chord = window_chord(limit, dy);
                for (var dx = max(x, -chord); dx <= min(last.x, chord); dx++) {
                    let tap = window_read(part, vec2i(dx, dy));
                    let covered = tap.a >= 0.5;
                    best = max(best, select(vec3f(LOWEST), sign * tap.rgb, covered));
                    seen = seen || covered;
                }
            }
        }
    }
    let color = select(origin.rgb, sign * best, seen);
    if !outside(id) {
        textureStore(target_image, vec2i(id.xy), vec4f(color, origin.a));
    }
}
