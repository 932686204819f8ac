// Which pixels may be edges (section 4.1, 4.2.1): local maxima of the gradient's magnitude along the
// gradient, or zero crossings of the Laplacian; 0 is none, 1 a weak and 2 a strong candidate. Or, without
// any thinning, the thresholded magnitude as an edge image.
// Cost: up to nine loads and about 40 operations.
#import gpu/grid

struct Params {
    /// 0: maxima of the gradient; 1: zero crossings of the Laplacian; 2: the magnitude itself.
    method: u32,
    /// Height from which on a candidate is weak, units of L.
    low: f32,
    /// Height from which on a candidate is strong, units of L.
    high: f32,
}

#params
// gx, gy, height, Laplacian; see edge_gradient.
#input gradient
#output target_image r32float

// Values nearer to each other than this ratio count as equal: decided by rounding, lines would be ragged.
const TIE: f32 = 1.0005;

fn height(p: vec2i) -> f32 {
    return fetch(gradient, 0u, p).z;
}

// True when the height at p is a maximum along its gradient. Of two equal neighbours, as both sides of a
// sharp step are, the darker one is it.
fn is_maximum(p: vec2i, v: vec4f) -> bool {
    let upright = abs(v.y) > abs(v.x);
    let signs = vec2i(select(vec2f(-1.0), vec2f(1.0), v.xy >= vec2f(0.0)));
    let straight = select(vec2i(signs.x, 0), vec2i(0, signs.y), upright);
    let slant = min(abs(v.x), abs(v.y)) / max(max(abs(v.x), abs(v.y)), 1e-30);
    let ahead = mix(height(p + straight), height(p + signs), slant);
    let behind = mix(height(p - straight), height(p - signs), slant);
    return v.z > behind * TIE && v.z * TIE >= ahead;
}

// True when the Laplacian changes its sign between p and a neighbour, and p is the nearer one to 0. Of two
// that are equally near, the left or upper one is it.
fn is_crossing(p: vec2i, own: f32) -> bool {
    for (var i = 0; i < 4; i++) {
        let back = select(1, -1, i >= 2);
        let other = fetch(gradient, 0u, p + select(vec2i(0, back), vec2i(back, 0), (i & 1) == 0)).w;
        let nearest = abs(own) * TIE < abs(other);
        let as_near = abs(own) <= abs(other) * TIE;
        if select(nearest, as_near, (back > 0)) && ((own >= 0.0) != (other >= 0.0)) {
            return true;
        }
    }
    return false;
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = pixel(id);
    let v = fetch(gradient, 0u, p);
    var result = 0.0;
    if params.method == 2u {
        let t = clamp((v.z - params.low) / max(params.high - params.low, 1e-3), 0.0, 1.0);
        result = 1.0 - t * t * (3.0 - 2.0 * t);
    } else if v.z > params.low {
        var candidate = false;
        if params.method == 0u {
            candidate = is_maximum(p, v);
        } else {
            candidate = is_crossing(p, v.w);
        }
        result = select(0.0, select(1.0, 2.0, v.z > params.high), candidate);
    }
    textureStore(target_image, vec2i(id.xy), vec4f(result));
}
