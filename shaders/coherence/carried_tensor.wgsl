// The smoothed structure tensor of a colour, where tensors of low contrast are taken from an earlier
// field before smoothing (thesis § 2.7.3, 6.2). Gradients by the 3x3 operator of (2.27).
// Cost: (8 + 2 radius)^2 / 64 gradients of nine loads each, and 4 radius + 2 multiply-adds per row and
// column, from memory that the workgroup shares.
#import gpu/grid

struct Params {
    /// Cut-off of the Gaussian, pixels, 0..=8.
    radius: i32,
    /// A tensor is valid above this lambda1 (2.164).
    threshold: f32,
    /// Weights of the derivative operator across the derivative: at the centre and beside it.
    smoothing: vec2f,
    /// Weights of the Gaussian at distance 0, 1, ...
    weights: array<vec4f, 3>,
}

#params
#input source, earlier
#output target_image rgba32float

// E, F and G on a square of 24 x 24 pixels, and smoothed along its rows.
var<workgroup> square: array<vec3f, 576>;
var<workgroup> smoothed: array<vec3f, 192>;

// Colour times coverage, and coverage.
fn tap(p: vec2i) -> vec4f {
    let v = fetch(source, 0u, p);
    return vec4f(v.rgb * v.a, v.a);
}

// The tensor of the gradient (2.34) at p, or the earlier one.
fn tensor_at(p: vec2i) -> vec3f {
    let along = params.smoothing.x;
    let across = params.smoothing.y;
    let left_up = tap(p + vec2i(-1, -1));
    let left = tap(p + vec2i(-1, 0));
    let left_down = tap(p + vec2i(-1, 1));
    let up = tap(p + vec2i(0, -1));
    let c = tap(p);
    let down = tap(p + vec2i(0, 1));
    let right_up = tap(p + vec2i(1, -1));
    let right = tap(p + vec2i(1, 0));
    let right_down = tap(p + vec2i(1, 1));
    let gx = 0.5 * ((along * right + across * (right_up + right_down))
        - (along * left + across * (left_up + left_down)));
    let gy = along * (0.5 * (down - up))
        + across * (0.5 * (left_down - left_up) + 0.5 * (right_down - right_up));
    // The quotient rule without its division: coverage squared times the gradient of the colour.
    let x = c.a * gx.rgb - c.rgb * gx.a;
    let y = c.a * gy.rgb - c.rgb * gy.a;
    let t = vec3f(dot(x, x), dot(x, y), dot(y, y));
    let d = (t.x - t.z) * 0.5;
    let lambda1 = (t.x + t.z) * 0.5 + sqrt(d * d + t.y * t.y);
    if lambda1 > params.threshold {
        return t;
    }
    return fetch(earlier, 1u, p).xyz;
}

fn main(
    @builtin(global_invocation_id) id: vec3u,
    @builtin(workgroup_id) group: vec3u,
    @builtin(local_invocation_id) local: vec3u,
) {
    let r = params.radius;
    let side = 8 + 2 * r;
    let first = i32(local.y * 8u + local.x);
    let corner = grid.origin + vec2i(group.xy) * 8 - r;
    // What the pass was promised; the picture goes on with its last tensor.
    let last = min(grid.origin + grid.size + r, grid.inputs[0].zw) - 1;
    let inverse = 1.0 / f32(side);
    for (var i = first; i < side * side; i += 64) {
        // i / side, which takes many more instructions; half a unit is more than any rounding.
        let y = i32((f32(i) + 0.5) * inverse);
        square[i] = tensor_at(clamp(corner + vec2i(i - y * side, y), vec2i(0), last));
    }
    workgroupBarrier();
    for (var i = first; i < 8 * side; i += 64) {
        let at = (i / 8) * side + i % 8 + r;
        var sum = params.weights[0].x * square[at];
        for (var k = 1; k <= r; k++) {
            sum += params.weights[k >> 2u][k & 3] * (square[at - k] + square[at + k]);
        }
        smoothed[i] = sum;
    }
    workgroupBarrier();
    let at = first + 8 * r;
    var sum = params.weights[0].x * smoothed[at];
    for (var k = 1; k <= r; k++) {
        sum += params.weights[k >> 2u][k & 3] * (smoothed[at - 8 * k] + smoothed[at + 8 * k]);
    }
    if !outside(id) {
        textureStore(target_image, vec2i(id.xy), vec4f(sum, 1.0));
    }
}
