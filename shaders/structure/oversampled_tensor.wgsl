// The structure tensor of Gaussian derivatives at twice the resolution, by resampling convolution
// (2.4.6). Cost: (2 radius + 1)^2 loads and as many multiply-adds on two vec4.
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
    // Weights of the pixels from -radius on for a position 1/4 pixel beyond the centre's.
    smoothing: array<vec4f, 10>,
    derivative: array<vec4f, 10>,
}

@group(0) @binding(1) var<uniform> params: Params;
@group(0) @binding(2) var source: texture_2d<f32>;
@group(0) @binding(3) var target_image: texture_storage_2d<rgba32float, write>;

// Colour times coverage, and coverage.
fn tap(p: vec2i) -> vec4f {
    let v = fetch(source, 0u, p);
    return vec4f(v.rgb * v.a, v.a);
}

// Smoothing and derivative weight of the pixel at distance j. Positions before the centre's, at even
// pixels, see the mirror image.
fn weights(j: i32, phase: i32) -> vec2f {
    let side = 2 * phase - 1;
    let i = side * j + params.radius;
    return vec2f(params.smoothing[i >> 2u][i & 3], f32(side) * params.derivative[i >> 2u][i & 3]);
}

struct Column {
    smoothed: vec4f,
    derived: vec4f,
}

// Derivatives are sums of differences from the middle: where all is flat they are exactly 0.
fn column(p: vec2i, phase: i32) -> Column {
    let middle = tap(p);
    var c = Column(vec4f(0.0), vec4f(0.0));
    for (var j = -params.radius; j <= params.radius; j++) {
        let value = tap(p + vec2i(0, j));
        let w = weights(j, phase);
        c.smoothed += w.x * value;
        c.derived += w.y * (value - middle);
    }
    return c;
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = pixel(id) >> vec2u(1u);
    let phase = pixel(id) & vec2i(1);
    let middle = column(p, phase.y).smoothed;
    var gx = vec4f(0.0);
    var gy = vec4f(0.0);
    for (var i = -params.radius; i <= params.radius; i++) {
        let c = column(p + vec2i(i, 0), phase.y);
        let w = weights(i, phase.x);
        gx += w.y * (c.smoothed - middle);
        gy += w.x * c.derived;
    }
    let t = outer_product(tap(p), gx, gy, params.scale, params.flags, params.threshold);
    textureStore(target_image, vec2i(id.xy), t);
}
