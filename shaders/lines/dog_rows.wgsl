// Rows of two Gaussians at once, on lightness and coverage: the first half of the isotropic
// difference of Gaussians (4.5, 4.7).
// Cost: two multiply-adds on vec2 per tap, 2 radius + 1 loads.
#import grid

struct Params {
    // Taps on each side of the centre.
    radius: i32,
    reserved: i32,
    reserved_pair: vec2i,
    // Weights at distance 0, 1, ...: standard deviations sigma and k sigma.
    narrow: array<vec4f, 64>,
    wide: array<vec4f, 64>,
}

@group(0) @binding(1) var<uniform> params: Params;
@group(0) @binding(2) var source: texture_2d<f32>;
@group(0) @binding(3) var target_image: texture_storage_2d<rgba32float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = pixel(id);
    let middle = fetch(source, 0u, p).xy;
    var narrow = params.narrow[0].x * middle;
    var wide = params.wide[0].x * middle;
    for (var i = 1; i <= params.radius; i++) {
        let o = vec2i(i, 0);
        let pair = fetch(source, 0u, p - o).xy + fetch(source, 0u, p + o).xy;
        narrow += params.narrow[i >> 2u][i & 3] * pair;
        wide += params.wide[i >> 2u][i & 3] * pair;
    }
    textureStore(target_image, vec2i(id.xy), vec4f(narrow, wide));
}
