// The rows of the Kuwahara filter's four subregions (thesis § 5.2): weighted sums to the left and to the
// right of every pixel.
// Cost: 2 count reads of workgroup memory and 10 multiply-adds each, count / 2 + 1 loads.
#import gpu/window

struct Params {
    /// Offset of the first weight from the pixel, towards the side.
    first: i32,
    /// Number of weights.
    count: u32,
    /// 1: all weights are equal.
    flat_weights: u32,
    /// Weights from offset `first` on.
    weights: array<vec4f, 32>,
}

#params
#input source
#output left_sums rgba32float
#output right_sums rgba32float
#output square_sums rg32float

const WINDOW_PIXELS: i32 = WINDOW_LINE;

fn window_tap(p: vec2i) -> vec4f {
    return fetch(source, 0u, p);
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    var left = vec4f(0.0);
    var right = vec4f(0.0);
    var squares = vec2f(0.0);
    let count = i32(params.count);
    let step = window_step(vec2i(count, 1)).x;
    for (var begin = 0; begin < count; begin += step) {
        let end = min(begin + step, count);
        let part = window_load_both(id, vec2i(params.first + begin, 0), vec2i(params.first + end - 1, 0));
        for (var i = begin; i < end; i++) {
            let w = params.weights[i >> 2u][i & 3];
            let d = vec2i(params.first + i, 0);
            let l = window_read_opposite(part, d);
            let r = window_read(part, d);
            left += (w * l.a) * vec4f(l.rgb, 1.0);
            right += (w * r.a) * vec4f(r.rgb, 1.0);
            squares += w * vec2f(l.a * dot(l.rgb, l.rgb), r.a * dot(r.rgb, r.rgb));
        }
    }
    if !outside(id) {
        textureStore(left_sums, vec2i(id.xy), left);
        textureStore(right_sums, vec2i(id.xy), right);
        textureStore(square_sums, vec2i(id.xy), vec4f(squares, 0.0, 0.0));
    }
}
