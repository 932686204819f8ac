// The Kuwahara filter (thesis § 5.2) from sums over the rows of its subregions: the mean of the
// subregion with the least variance.
// Cost: 6 count loads and 20 multiply-adds each.
#import grid

struct Params {
    // Offset of the first weight from the pixel, towards the side.
    first: i32,
    // Weights.
    count: u32,
    // 1: all weights are equal.
    flat_weights: u32,
    // Differences of variance up to this share are none.
    tie: f32,
    weights: array<vec4f, 32>,
}

@group(0) @binding(1) var<uniform> params: Params;
@group(0) @binding(2) var left_sums: texture_2d<f32>;
@group(0) @binding(3) var right_sums: texture_2d<f32>;
@group(0) @binding(4) var square_sums: texture_2d<f32>;
@group(0) @binding(5) var source: texture_2d<f32>;
@group(0) @binding(6) var target_image: texture_storage_2d<rgba32float, write>;

// Rounding of a variance, as a share of the mean square.
const ROUNDING: f32 = 4e-6;

// A subregion of which less than this share is covered says nothing.
const SEEN: f32 = 1e-3;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = pixel(id);
    // Left and right below the pixel, then right and left above it: W_0 to W_3 (5.1).
    var sums = array<vec4f, 4>(vec4f(0.0), vec4f(0.0), vec4f(0.0), vec4f(0.0));
    var squares = vec4f(0.0);
    for (var i = 0u; i < params.count; i++) {
        let w = params.weights[i / 4u][i % 4u];
        let d = vec2i(0, params.first + i32(i));
        let below = fetch(square_sums, 2u, p + d).xy;
        let above = fetch(square_sums, 2u, p - d).yx;
        squares += w * vec4f(below, above);
        sums[0] += w * fetch(left_sums, 0u, p + d);
        sums[1] += w * fetch(right_sums, 1u, p + d);
        sums[2] += w * fetch(right_sums, 1u, p - d);
        sums[3] += w * fetch(left_sums, 0u, p - d);
    }
    let origin = fetch(source, 3u, p);
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
    textureStore(target_image, vec2i(id.xy), vec4f(select(origin.rgb, color, total > 0.0), origin.a));
}
