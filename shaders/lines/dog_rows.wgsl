// Rows of two Gaussians at once, on lightness and coverage: the first half of the isotropic
// difference of Gaussians (4.5, 4.7).
// Cost: two multiply-adds on vec2 per tap, 2 radius reads of workgroup memory,
// radius / 2 + 2 loads.
#import gpu/window

struct Params {
    /// Taps on each side of the centre.
    radius: i32,
    /// Weights at distance 0, 1, ... for standard deviation sigma.
    narrow: array<vec4f, 64>,
    /// Weights for standard deviation k sigma.
    wide: array<vec4f, 64>,
}

#params
#input source
#output target_image rgba32float

const WINDOW_PIXELS: i32 = WINDOW_LINE;

fn window_tap(p: vec2i) -> vec4f {
    return fetch(source, 0u, p);
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    let middle = window_tap(group_pixel(id)).xy;
    var narrow = params.narrow[0].x * middle;
    var wide = params.wide[0].x * middle;
    let step = window_step(vec2i(params.radius, 1)).x;
    for (var first = 1; first <= params.radius; first += step) {
        let last = min(first + step - 1, params.radius);
        let part = window_load_both(id, vec2i(first, 0), vec2i(last, 0));
        for (var i = first; i <= last; i++) {
            let o = vec2i(i, 0);
            let pair = window_read_opposite(part, o).xy + window_read(part, o).xy;
            narrow += params.narrow[i >> 2u][i & 3] * pair;
            wide += params.wide[i >> 2u][i & 3] * pair;
        }
    }
    if !outside(id) {
        textureStore(target_image, vec2i(id.xy), vec4f(narrow, wide));
    }
}
