// The structure tensor of each pixel's gradient (2.34), by a separable derivative operator.
// Cost: (2 radius + 1)^2 loads and 4 radius (2 radius + 1) multiply-adds on vec4.
#import grid
#import outer_product

struct Params {
    radius: i32,
    // Bit 0: the gradient of the luma alone. Bit 1: divide each channel's tensor by its gradient's
    // magnitude (2.133).
    flags: u32,
    // Factor on the colours.
    scale: f32,
    // A tensor is valid above this lambda1 (2.164).
    threshold: f32,
    // Weights at distance 0, 1, ... across the derivative and along it.
    smoothing: array<vec4f, 5>,
    derivative: array<vec4f, 5>,
}

@group(0) @binding(1) var<uniform> params: Params;
@group(0) @binding(2) var source: texture_2d<f32>;
@group(0) @binding(3) var target_image: texture_storage_2d<rgba32float, write>;

struct Column {
    smoothed: vec4f,
    derived: vec4f,
}

// Colour times coverage, and coverage.
fn tap(p: vec2i) -> vec4f {
    let v = fetch(source, 0u, p);
    return vec4f(v.rgb * v.a, v.a);
}

fn column(p: vec2i) -> Column {
    var c = Column(params.smoothing[0].x * tap(p), vec4f(0.0));
    for (var j = 1; j <= params.radius; j++) {
        let above = tap(p - vec2i(0, j));
        let below = tap(p + vec2i(0, j));
        c.smoothed += params.smoothing[j >> 2u][j & 3] * (above + below);
        c.derived += params.derivative[j >> 2u][j & 3] * (below - above);
    }
    return c;
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = pixel(id);
    var gx = vec4f(0.0);
    var gy = params.smoothing[0].x * column(p).derived;
    for (var i = 1; i <= params.radius; i++) {
        let left = column(p - vec2i(i, 0));
        let right = column(p + vec2i(i, 0));
        gx += params.derivative[i >> 2u][i & 3] * (right.smoothed - left.smoothed);
        gy += params.smoothing[i >> 2u][i & 3] * (left.derived + right.derived);
    }
    let t = outer_product(tap(p), gx, gy, params.scale, params.flags, params.threshold);
    textureStore(target_image, vec2i(id.xy), t);
}
