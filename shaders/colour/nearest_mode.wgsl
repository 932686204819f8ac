// Each pixel takes the colour of those modes around it, found at a coarser level, that its own colour is near (joint
// bilateral upsampling, Kopf et al. 2007); small things that are like none of them keep their own.
// Cost: ten loads and nine exponentials.
#import gpu/grid

struct Params {
    /// Levels of the pyramid from the picture up to the modes.
    levels: u32,
    /// Exponent, base 2, per squared difference in colour.
    range: f32,
    /// 1 / difference to the modes from which on small things keep their colours.
    inverse_least: f32,
}

#params
#input source, modes
#output target_image rgba32float

// Weights of three pixels by the quadratic B-spline, at a share t of the way through the middle one.
fn spline(t: f32) -> vec3f {
    return vec3f(0.5 * (1.0 - t) * (1.0 - t), 0.75 - (t - 0.5) * (t - 0.5), 0.5 * t * t);
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = pixel(id);
    let own = fetch(source, 0u, p);
    let middle = p >> vec2u(params.levels);
    let side = 1 << params.levels;
    let share = (vec2f(p - middle * side) + 0.5) / f32(side);
    let columns = spline(share.x);
    let rows = spline(share.y);
    var sum = vec4f(0.0);
    for (var y = 0; y < 3; y++) {
        for (var x = 0; x < 3; x++) {
            let mode = fetch(modes, 1u, middle + vec2i(x, y) - 1);
            let d = mode.rgb - own.rgb;
            let near = exp2(max(params.range * dot(d, d), -60.0));
            sum += mode.a * columns[x] * rows[y] * near * vec4f(d, 1.0);
        }
    }
    let d = select(vec3f(0.0), sum.rgb / sum.a, sum.a > 1e-30);
    let t = clamp(sqrt(dot(d, d)) * params.inverse_least - 1.0, 0.0, 1.0);
    let kept = t * t * (3.0 - 2.0 * t);
    textureStore(target_image, vec2i(id.xy), vec4f(own.rgb + d * (1.0 - kept), own.a));
}
