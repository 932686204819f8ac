// One axis of a separable Gaussian on four channels (2.21).
// Cost: radius + 1 multiply-adds on vec4, 2 radius + 1 loads.
#import grid

struct Params {
    // (1, 0) for rows, (0, 1) for columns.
    axis: vec2i,
    radius: i32,
    // Bit 0: multiply colour by alpha on reading. Bit 1: divide by alpha on writing.
    coverage: u32,
    weights: array<vec4f, 64>,
}

@group(0) @binding(1) var<uniform> params: Params;
@group(0) @binding(2) var source: texture_2d<f32>;
@group(0) @binding(3) var target_image: texture_storage_2d<rgba32float, write>;

fn tap(p: vec2i) -> vec4f {
    let v = fetch(source, 0u, p);
    if (params.coverage & 1u) != 0u {
        return vec4f(v.rgb * v.a, v.a);
    }
    return v;
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = pixel(id);
    var sum = params.weights[0].x * tap(p);
    for (var i = 1; i <= params.radius; i++) {
        let o = i * params.axis;
        sum += params.weights[i >> 2u][i & 3] * (tap(p - o) + tap(p + o));
    }
    if (params.coverage & 2u) != 0u {
        sum = vec4f(select(vec3f(0.0), sum.rgb / sum.a, sum.a > 1e-6), sum.a);
    }
    textureStore(target_image, vec2i(id.xy), sum);
}
