// The Kuwahara filter (thesis § 5.2) from sums over the rows of its subregions: the mean of the
// subregion with the least variance.
// Cost: 6 count reads of workgroup memory and 20 multiply-adds each, 3 count / 2 + 4 loads.
#import gpu/window

struct Params {
    /// Offset of the first weight from the pixel, towards the side.
    first: i32,
    /// Number of weights.
    count: u32,
    /// 1: all weights are equal.
    flat_weights: u32,
    /// Differences of variance up to this share are none.
    tie: f32,
    /// Weights from offset `first` on.
    weights: array<vec4f, 32>,
}

#params
#input left_sums, right_sums, square_sums, source
#output target_image rgba32float

// Rounding of a variance, as a share of the mean square.
const ROUNDING: f32 = 4e-6;

// A subregion of which less than this share is covered says nothing.
const SEEN: f32 = 1e-3;

// The input that windows hold.
var<private> held: u32;

const WINDOW_PIXELS: i32 = WINDOW_LINE;

fn window_tap(p: vec2i) -> vec4f {
    switch held {
        case 0u: {
            return fetch(left_sums, 0u, p);
        }
        case 1u: {
            return fetch(right_sums, 1u, p);
        }
        default: {
            return fetch(square_sums, 2u, p);
        }
    }
}

struct Columns {
    below: vec4f,
    above: vec4f,
}

// Weighted sums of an input's columns below and above the pixel.
fn columns(id: vec3u, input: u32) -> Columns {
    held = input;
    var sums = Columns();
    let count = i32(params.count);
    let step = window_step(vec2i(1, count)).y;
    for (var begin = 0; begin < count; begin += step) {
        let end = min(begin + step, count);
        let first = vec2i(0, params.first + begin);
        let part = window_load_both(id, first, vec2i(0, params.first + end - 1));
        for (var i = begin; i < end; i++) {
            let w = params.weights[i >> 2u][i & 3];
            let d = vec2i(0, params.first + i);
            sums.below += w * window_read(part, d);
            sums.above += w * window_read_opposite(part, d);
        }
    }
    return sums;
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    let left = columns(id, 0u);
    let right = columns(id, 1u);
    let square = columns(id, 2u);
    // Left and right below the pixel, then right and left above it: W_0 to W_3 (5.1).
    let sums = array(left.below, right.below, right.above, left.above);
    let squares = vec4f(square.below.xy, square.above.yx);
    let origin = fetch(source, 3u, group_pixel(id));
    let cover = vec4f(sums[0].a, sums[1].a, sums[2].a, sums[3].a);
    let seen = cover > vec4f(SEEN);
    let n = select(vec4f(0.0), 1.0 / cover, seen);
    let r = vec4f(sums[0].r, sums[1].r, sums[2].r, sums[3].r) * n;
    let g = vec4f(sums[0].g, sums[1].g, sums[2].g, sums[3].g) * n;
    let b = vec4f(sums[0].b, sums[1].b, sums[2].b, sums[3].b) * n;
    let mean_squares = squares * n;
    let variance = select(vec4f(3e38), max(mean_squares - (r * r + g * g + b * b), vec4f(0.0)), seen);
    let least = min(min(variance.x, variance.y), min(variance.z, variance.w));
    // Subregions that differ by rounding only share the result, so that it leans to no side.
    let limit = vec4f(least * (1.0 + params.tie)) + ROUNDING * mean_squares;
    let chosen = select(vec4f(0.0), cover, seen & (variance <= limit));
    let total = dot(chosen, vec4f(1.0));
    let color = vec3f(dot(chosen, r), dot(chosen, g), dot(chosen, b)) / total;
    if !outside(id) {
        textureStore(target_image, vec2i(id.xy), vec4f(select(origin.rgb, color, total > 0.0), origin.a));
    }
}
