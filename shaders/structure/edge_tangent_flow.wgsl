// One pass of the edge tangent flow (2.134-2.136) over a disc, a row or a column, on tensors of unit
// vectors: the weighted sum of the vectors around is the weighted sum of their tensors times the
// centre's vector. Cost: up to (2 reach + 1)^2 loads and 12 operations each.
#import grid
#import tensor

struct Params {
    // Largest distance in x and in y, pixels.
    reach: vec2i,
    // Neighbours lie nearer than this: squared radius.
    limit: f32,
    // 1: the last pass writes w, not the magnitude.
    last: u32,
    // Spatial weight at distance 0, 1, ... along each axis.
    weights: array<vec4f, 6>,
}

@group(0) @binding(1) var<uniform> params: Params;
@group(0) @binding(2) var source: texture_2d<f32>;
@group(0) @binding(3) var largest: texture_2d<f32>;
@group(0) @binding(4) var target_image: texture_storage_2d<rgba32float, write>;

fn weight(i: i32) -> f32 {
    return params.weights[abs(i) >> 2u][abs(i) & 3];
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = pixel(id);
    // Sums of the tensors around, plain and by their magnitude.
    var plain = vec3f(0.0);
    var strong = vec3f(0.0);
    for (var j = -params.reach.y; j <= params.reach.y; j++) {
        for (var i = -params.reach.x; i <= params.reach.x; i++) {
            if f32(i * i + j * j) < params.limit {
                let t = fetch(source, 0u, p + vec2i(i, j));
                let w = weight(i) * weight(j);
                plain += w * t.xyz;
                strong += w * t.w * t.xyz;
            }
        }
    }
    let inverse = 1.0 / max(fetch(largest, 1u, vec2i(0)).x, TENSOR_SMALLEST);
    let own = fetch(source, 0u, p);
    // (2.135), twice: m(y) + (1 - m(x)).
    let m = strong * inverse + (1.0 - own.w * inverse) * plain;
    let sum = tensor_axis((m.x - m.z) * 0.5, m.y);
    let n = tensor_axis((own.x - own.z) * 0.5, own.y).major;
    var v = vec2f(m.x * n.x + m.y * n.y, m.y * n.x + m.z * n.y);
    let length = dot(v, v);
    if length > 1e-24 {
        v *= 1.0 / sqrt(length);
    } else {
        v = n;
    }
    var keeps = m.x + m.z < 1e-12;
    // A pixel without a gradient takes the axis that vectors would turn to, where there is one.
    if own.x + own.z == 0.0 {
        v = sum.major;
        keeps = keeps || sum.radius < 0.025 * (m.x + m.z);
    }
    var t = vec3f(v.x * v.x, v.x * v.y, v.y * v.y);
    if keeps {
        t = own.xyz;
    }
    var w = own.w;
    if params.last != 0u {
        w = select(0.0, 1.0, t.x + t.z > 0.0);
    }
    textureStore(target_image, vec2i(id.xy), vec4f(t, w));
}
