// One axis of a separable Gaussian on four channels (2.21).
// Cost: radius + 1 multiply-adds on vec4, 2 radius reads of workgroup memory, radius / 2 + 2 loads.
#import shared/coverage
#import gpu/window

struct Params {
    /// (1, 0) for rows, (0, 1) for columns.
    axis: vec2i,
    /// Pixels on each side of the centre.
    radius: i32,
    /// Bit 0: multiply colour by alpha on reading. Bit 1: divide by alpha on writing.
    coverage: u32,
    /// Weights at distance 0, 1, ...
    weights: array<vec4f, 64>,
}

#params
#input source
#output target_image rgba32float

const WINDOW_PIXELS: i32 = WINDOW_LINE;

fn window_tap(p: vec2i) -> vec4f {
    let v = fetch(source, 0u, p);
    if (params.coverage & 1u) != 0u {
        return premultiply(v);
    }
    return v;
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    var sum = params.weights[0].x * window_tap(group_pixel(id));
    let fitting = window_step((params.radius - 1) * params.axis + 1);
    let step = max(fitting.x, fitting.y);
    for (var first = 1; first <= params.radius; first += step) {
        let last = min(first + step - 1, params.radius);
        let part = window_load_both(id, first * params.axis, last * params.axis);
        for (var i = first; i <= last; i++) {
            let o = i * params.axis;
            let pair = window_read_opposite(part, o) + window_read(part, o);
            sum += params.weights[i >> 2u][i & 3] * pair;
        }
    }
    if (params.coverage & 2u) != 0u {
        sum = vec4f(unpremultiply(sum).rgb, full_or(sum.a));
    }
    if !outside(id) {
        textureStore(target_image, vec2i(id.xy), sum);
    }
}
