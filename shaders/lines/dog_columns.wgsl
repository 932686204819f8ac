// Columns of two Gaussians at once, their difference and its threshold: the second half of the
// isotropic extended difference of Gaussians (4.7-4.10).
// Cost: one multiply-add on vec4 per tap, 2 radius + 1 loads.
#import grid
#import edge_threshold

struct Params {
    radius: i32,
    // How the response becomes an edge image, see edge_threshold.
    threshold: u32,
    // Weights of the smoothed lightness and of the difference of Gaussians.
    base: f32,
    edge: f32,
    epsilon: f32,
    phi: f32,
    reserved_pair: vec2i,
    narrow: array<vec4f, 64>,
    wide: array<vec4f, 64>,
}

@group(0) @binding(1) var<uniform> params: Params;
@group(0) @binding(2) var source: texture_2d<f32>;
@group(0) @binding(3) var target_image: texture_storage_2d<r32float, write>;

fn weights(i: i32) -> vec4f {
    return vec4f(vec2f(params.narrow[i >> 2u][i & 3]), vec2f(params.wide[i >> 2u][i & 3]));
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = pixel(id);
    var sum = weights(0) * fetch(source, 0u, p);
    for (var i = 1; i <= params.radius; i++) {
        let o = vec2i(0, i);
        sum += weights(i) * (fetch(source, 0u, p - o) + fetch(source, 0u, p + o));
    }
    var result = edge_uncovered(params.threshold);
    if min(sum.y, sum.w) > 1e-6 {
        let u = dog_response(sum.x / sum.y, sum.z / sum.w, params.base, params.edge);
        result = edge_threshold(u, params.threshold, params.epsilon, params.phi);
    }
    textureStore(target_image, vec2i(id.xy), vec4f(result));
}
