// Columns of two Gaussians at once, their difference and its threshold: the second half of the
// isotropic extended difference of Gaussians (4.7-4.10).
// Cost: one multiply-add on vec4 per tap, 2 radius reads of workgroup memory, radius / 2 + 2 loads.
#import gpu/window
#import shared/edge_threshold

struct Params {
    /// Taps on each side of the centre.
    radius: i32,
    /// How the response becomes an edge image: 0 not at all, 1 binary (4.6), 2 tanh (4.8), 3 smoothstep.
    threshold: u32,
    /// Weight of the smoothed lightness.
    base: f32,
    /// Weight of the difference of Gaussians.
    edge: f32,
    /// Response from which on there is no line, units of L.
    epsilon: f32,
    /// Steepness of the ramp, per unit of L.
    phi: f32,
    /// Share of the paper that shows through lines, which are narrower than a pixel; 0 where they are not.
    faintness: f32,
    /// Weights at distance 0, 1, ... for standard deviation sigma.
    narrow: array<vec4f, 64>,
    /// Weights for standard deviation k sigma.
    wide: array<vec4f, 64>,
}

#params
#input source
#output target_image r32float

fn weights(i: i32) -> vec4f {
    return vec4f(vec2f(params.narrow[i >> 2u][i & 3]), vec2f(params.wide[i >> 2u][i & 3]));
}

const WINDOW_PIXELS: i32 = WINDOW_LINE;

fn window_tap(p: vec2i) -> vec4f {
    return fetch(source, 0u, p);
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    var sum = weights(0) * window_tap(group_pixel(id));
    let step = window_step(vec2i(1, params.radius)).y;
    for (var first = 1; first <= params.radius; first += step) {
        let last = min(first + step - 1, params.radius);
        let part = window_load_both(id, vec2i(0, first), vec2i(0, last));
        for (var i = first; i <= last; i++) {
            let o = vec2i(0, i);
            sum += weights(i) * (window_read_opposite(part, o) + window_read(part, o));
        }
    }
    var result = edge_uncovered(params.threshold);
    if min(sum.y, sum.w) > LEAST_COVERAGE {
        let u = dog_of_sums(sum.xy, sum.zw, params.base, params.edge);
        result = edge_of_response(u, params.threshold, params.epsilon, params.phi, params.faintness);
    }
    if !outside(id) {
        textureStore(target_image, vec2i(id.xy), vec4f(result));
    }
}
