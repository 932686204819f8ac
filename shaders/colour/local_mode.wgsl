// Mode of the colours around each pixel that its own colour belongs to, by mean shift in colour (Comaniciu and Meer
// 2002): the mean of the colours around, weighed by their distance and by their difference to the mean so far.
// Cost: a load and an exponential per pixel of the window, a disc of about 3.1 radius^2, in each round.
#import gpu/grid
#import shared/coverage

struct Params {
    /// Pixels on each side of the centre.
    radius: i32,
    /// Rounds.
    rounds: i32,
    /// Exponent, base 2, per squared pixel of distance.
    domain: f32,
    /// Exponent, base 2, per squared difference in colour.
    range: f32,
}

#params
#input source
#output target_image rgba32float

// The mean of the differences to `mode` around pixel p.
fn shift(p: vec2i, mode: vec3f) -> vec3f {
    var sum = vec4f(0.0);
    for (var dy = -params.radius; dy <= params.radius; dy++) {
        for (var dx = -params.radius; dx <= params.radius; dx++) {
            let distance2 = dx * dx + dy * dy;
            if distance2 <= params.radius * params.radius {
                let tap = fetch(source, 0u, p + vec2i(dx, dy));
                let d = tap.rgb - mode;
                let exponent = params.range * dot(d, d) + params.domain * f32(distance2);
                sum += tap.a * exp2(max(exponent, -125.0)) * vec4f(d, 1.0);
            }
        }
    }
    return select(vec3f(0.0), sum.rgb / sum.a, sum.a > LEAST_COVERAGE);
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = pixel(id);
    let own = fetch(source, 0u, p);
    var mode = own.rgb;
    for (var i = 0; i < params.rounds; i++) {
        mode += shift(p, mode);
    }
    textureStore(target_image, vec2i(id.xy), vec4f(mode, own.a));
}
