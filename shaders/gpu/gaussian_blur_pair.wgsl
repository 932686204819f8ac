// Rows and columns of gaussian_blur in one dispatch, for windows of at most 17 x 17 pixels: what rows sum is held in
// workgroup memory, and then their sums. The sums are those of the two passes, in the same order.
// Cost: (1 + radius / 8)^2 of what rows sum, 2 radius reads of workgroup memory for 1 + radius / 8 rows, as many for the
// column.
#import gpu/grid
#import shared/coverage

// Its sides, and how many pixels of each invocation there are of what rows sum and of their sums.
const PAIR_SIDE: i32 = 16;
const PAIR_TAPS: i32 = 4;
const PAIR_ROWS: i32 = 2;

var<workgroup> pair_window: array<vec4f, 1024>;

// What rows sum at p, clamped to the picture's edge.
fn pair_tap(p: vec2i) -> vec4f {
    let v = pair_source(clamp(p, vec2i(0), grid.full - 1));
    if (rows_params.coverage & 1u) != 0u {
        return premultiply(v);
    }
    return v;
}

// The window's values around the one at `at`, each `stride` from the next.
fn pair_sum(at: i32, stride: i32) -> vec4f {
    let radius = rows_params.radius;
    var sum = rows_params.weights[0].x * pair_window[at];
    for (var i = 1; i <= radius; i++) {
        let pair = pair_window[at - i * stride] + pair_window[at + i * stride];
        sum += rows_params.weights[i >> 2u][i & 3] * pair;
    }
    return sum;
}

@compute @workgroup_size(16, 16)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(local_invocation_index) first: u32) {
    let index = i32(first);
    let radius = rows_params.radius;
    let begin = vec2i(id.xy & vec2u(0xfffffff0u));
    // Columns and rows of the workgroup that have a texel to write, and those with the taps of all.
    let size = min(grid.size - begin, vec2i(PAIR_SIDE));
    let wide = size + 2 * radius;
    let corner = grid.origin + begin - radius;
    pair_hold(corner, wide, index);

    var taps: array<vec4f, PAIR_TAPS>;
    for (var k = 0; k < PAIR_TAPS; k++) {
        let i = index + 256 * k;
        if i < wide.x * wide.y {
            taps[k] = pair_tap(corner + vec2i(i % wide.x, i / wide.x));
        }
    }
    workgroupBarrier();
    for (var k = 0; k < PAIR_TAPS; k++) {
        let i = index + 256 * k;
        if i < wide.x * wide.y {
            pair_window[i] = taps[k];
        }
    }
    workgroupBarrier();

    var rows: array<vec4f, PAIR_ROWS>;
    for (var k = 0; k < PAIR_ROWS; k++) {
        let i = index + 256 * k;
        if i < PAIR_SIDE * wide.y && i % PAIR_SIDE < size.x {
            rows[k] = pair_sum((i / PAIR_SIDE) * wide.x + i % PAIR_SIDE + radius, 1);
        }
    }
    workgroupBarrier();
    for (var k = 0; k < PAIR_ROWS; k++) {
        let i = index + 256 * k;
        if i < PAIR_SIDE * wide.y {
            pair_window[i] = rows[k];
        }
    }
    workgroupBarrier();

    if outside(id) {
        return;
    }
    let local = vec2i(id.xy) - begin;
    var sum = pair_sum((local.y + radius) * PAIR_SIDE + local.x, PAIR_SIDE);
    if (columns_params.coverage & 2u) != 0u {
        sum = vec4f(unpremultiply(sum).rgb, full_or(sum.a));
    }
    textureStore(target_image, vec2i(id.xy), sum);
}
