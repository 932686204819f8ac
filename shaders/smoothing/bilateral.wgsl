// The bilateral filter with an isotropic window (3.4), or one axis of its xy-separable form (§ 3.3);
// the range is measured as Euclidean distance of the three colour channels.
// Cost: one read of workgroup memory and one exponential per pixel of the window, a disc of about
// 3.1 radius^2 or a line of 2 radius + 1 pixels; radius^2 / 16 + radius / 2 + 1 loads and, where windows
// go in parts, about as many again.
#import shared/coverage
#import gpu/window

struct Params {
    /// Pixels on each side of the centre, along x and along y; the larger one is the window's radius.
    extent: vec2i,
    /// Exponent, base 2, per squared pixel of distance.
    domain: f32,
    /// Exponent, base 2, per squared difference in range.
    range: f32,
}

#params
#input source
#output target_image rgba32float

const WINDOW_PIXELS: i32 = WINDOW_AREA;

fn window_tap(p: vec2i) -> vec4f {
    return fetch(source, 0u, p);
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    let p = group_pixel(id);
    let radius = max(params.extent.x, params.extent.y);
    let origin = fetch(source, 0u, p);
    // Loops take no parameter from memory that they can hold.
    let domain = params.domain;
    let range = params.range;
    // Of the differences to the centre, so that flat parts stay flat to the last bit.
    var sum = vec4f(0.0);
    let step = window_step(2 * params.extent + 1);
    for (var y = -params.extent.y; y <= params.extent.y; y += step.y) {
        for (var x = -params.extent.x; x <= params.extent.x; x += step.x) {
            let last = min(vec2i(x, y) + step - 1, params.extent);
            let part = window_load(id, vec2i(x, y), last);
            for (var dy = y; dy <= last.y; dy++) {
                let chord = window_chord(radius * radius, dy);
                for (var dx = max(x, -chord); dx <= min(last.x, chord); dx++) {
                    let distance2 = dx * dx + dy * dy;
                    let tap = window_read(part, vec2i(dx, dy));
                    let d = tap.rgb - origin.rgb;
                    let exponent = range * dot(d, d) + domain * f32(distance2);
                    let weight = tap.a * exp2(max(exponent, -125.0));
                    sum += weight * vec4f(d, 1.0);
                }
            }
        }
    }
    let moved = select(vec3f(0.0), sum.rgb / sum.a, sum.a > LEAST_COVERAGE);
    if !outside(id) {
        textureStore(target_image, vec2i(id.xy), vec4f(origin.rgb + moved, origin.a));
    }
}
