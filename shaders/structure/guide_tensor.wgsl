// Adds the gradient of a normal, depth or object image to a tensor, as further channels of the
// multi-image gradient (2.34). Cost: 10 loads and about 60 operations.
#import gpu/grid
#import shared/tensor

struct Params {
    /// 0 normal, 1 depth, 2 object id.
    kind: u32,
    /// Factor on the guide's tensor.
    weight: f32,
    /// A tensor is valid (w = 1) above this lambda1 (2.164).
    threshold: f32,
}

#params
#input source, guide
#output target_image rgba32float

// Where there is nothing, or no number, the depth is far behind everything.
const FAR: f32 = 1e30;

// By bits: shader compilers may assume that NaN and infinity do not exist.
fn finite(v: vec4f) -> vec4<bool> {
    return (bitcast<vec4u>(v) & vec4u(0x7f800000u)) != vec4u(0x7f800000u);
}

// The guide at p without NaN and infinity. Normal: components times validity, and validity.
fn clean(p: vec2i) -> vec4f {
    let v = fetch(guide, 1u, p);
    let good = finite(v);
    if params.kind == 0u {
        let valid = select(0.0, clamp(v.w, 0.0, 1.0), all(good));
        let normal = select(vec3f(0.0), clamp(v.xyz, vec3f(-1.0), vec3f(1.0)), good.xyz);
        return vec4f(normal * valid, valid);
    }
    if params.kind == 1u {
        return vec4f(select(FAR, min(v.x, FAR), good.x && v.x > 0.0), 0.0, 0.0, 0.0);
    }
    return vec4f(select(0.0, v.x, good.x), 0.0, 0.0, 0.0);
}

// What the pixel at p counts for in the gradient at a pixel of guide value `centre`.
fn tap(p: vec2i, centre: vec4f) -> vec4f {
    let v = clean(p);
    if params.kind == 0u {
        return v;
    }
    if params.kind == 1u {
        let relative = (v.x - centre.x) / ((v.x + centre.x) * 0.5);
        return vec4f(clamp(relative, -1.0, 1.0), 0.0, 0.0, 0.0);
    }
    return vec4f(select(0.0, 1.0, abs(v.x - centre.x) > 0.5), 0.0, 0.0, 0.0);
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = pixel(id);
    let c = clean(p);
    let nw = tap(p + vec2i(-1, -1), c);
    let n = tap(p + vec2i(0, -1), c);
    let ne = tap(p + vec2i(1, -1), c);
    let w = tap(p + vec2i(-1, 0), c);
    let e = tap(p + vec2i(1, 0), c);
    let sw = tap(p + vec2i(-1, 1), c);
    let s = tap(p + vec2i(0, 1), c);
    let se = tap(p + vec2i(1, 1), c);
    // The optimized 3x3 operator (2.26, 2.27), half the weights.
    var gx = 0.091484375 * ((ne - nw) + (se - sw)) + 0.31703125 * (e - w);
    var gy = 0.091484375 * ((sw - nw) + (se - ne)) + 0.31703125 * (s - n);
    if params.kind == 0u {
        gx = c.w * gx - c * gx.w;
        gy = c.w * gy - c * gy.w;
    }
    let x = gx.xyz;
    let y = gy.xyz;
    var t = fetch(source, 0u, p);
    t.x += params.weight * (x.x * x.x + x.y * x.y + x.z * x.z);
    t.y += params.weight * (x.x * y.x + x.y * y.y + x.z * y.z);
    t.z += params.weight * (y.x * y.x + y.y * y.y + y.z * y.z);
    let lambda1 = (t.x + t.z) * 0.5 + tensor_axis((t.x - t.z) * 0.5, t.y).radius;
    t.w = select(0.0, 1.0, lambda1 > params.threshold);
    textureStore(target_image, vec2i(id.xy), t);
}
