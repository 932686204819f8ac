// One pass of the edge tangent flow (2.134-2.136) over a disc, a row or a column, on tensors of unit
// vectors: the weighted sum of the vectors around is the weighted sum of their tensors times the
// centre's vector.
// Cost: up to (2 reach + 1)^2 reads of workgroup memory and 12 operations each; reach^2 / 16 + reach / 2 + 1
// loads and, where windows go in parts, about as many again.
#import gpu/window
#import shared/tensor

struct Params {
    /// Largest distance in x and in y, pixels.
    reach: vec2i,
    /// Neighbours lie nearer than this: squared radius.
    limit: f32,
    /// 1: the last pass writes w, not the magnitude.
    last: u32,
    /// Spatial weight at distance 0, 1, ... along each axis.
    weights: array<vec4f, 6>,
}

#params
#input source, largest
#output target_image rgba32float

fn weight(i: i32) -> f32 {
    return params.weights[abs(i) >> 2u][abs(i) & 3];
}

const WINDOW_PIXELS: i32 = WINDOW_AREA;

fn window_tap(p: vec2i) -> vec4f {
    return fetch(source, 0u, p);
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    let p = group_pixel(id);
    // Loops take no parameter from memory that they can hold.
    let limit = params.limit;
    // Sums of the tensors around, plain and by their magnitude.
    var plain = vec3f(0.0);
    var strong = vec3f(0.0);
    let step = window_step(2 * params.reach + 1);
    for (var y = -params.reach.y; y <= params.reach.y; y += step.y) {
        for (var x = -params.reach.x; x <= params.reach.x; x += step.x) {
            let end = min(vec2i(x, y) + step - 1, params.reach);
            let part = window_load(id, vec2i(x, y), end);
            for (var j = y; j <= end.y; j++) {
                let across = weight(j);
                for (var i = x; i <= end.x; i++) {
                    if f32(i * i + j * j) < limit {
                        let t = window_read(part, vec2i(i, j));
                        let w = weight(i) * across;
                        plain += w * t.xyz;
                        strong += w * t.w * t.xyz;
                    }
                }
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
    if !outside(id) {
        textureStore(target_image, vec2i(id.xy), vec4f(t, w));
    }
}
