// Two paintings of one picture, whose strokes are at different places, faded into one another.
// Cost: five loads and about 40 operations.
#import gpu/grid

struct Params {
    /// Share of the second one, 0..=1.
    share: f32,
}

#params
#input source, first, first_heights, second, second_heights
#output target_image rgba32float
#output heights rgba32float

// Height about which paint is.
const MIDDLE: f32 = 0.55;
// Units of Lab that a unit of height counts.
const HEIGHT: f32 = 20.0;
// How much stronger the mean of both may become, so that half of each shows as much as one alone.
const MOST: f32 = 1.6;

// How far a painting is from the picture.
fn apart(painted: vec4f, height: f32, v: vec4f) -> vec4f {
    return vec4f(painted.rgb - v.rgb, HEIGHT * (height - MIDDLE));
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = pixel(id);
    let v = fetch(source, 0u, p);
    let a = apart(fetch(first, 1u, p), fetch(first_heights, 2u, p).x, v);
    let b = apart(fetch(second, 3u, p), fetch(second_heights, 4u, p).x, v);
    let mean = (1.0 - params.share) * a + params.share * b;
    let wanted = (1.0 - params.share) * dot(a, a) + params.share * dot(b, b);
    let d = mean * min(sqrt(wanted / max(dot(mean, mean), 1e-6)), MOST);
    textureStore(target_image, vec2i(id.xy), vec4f(v.rgb + d.rgb, v.a));
    textureStore(heights, vec2i(id.xy), vec4f(vec3f(MIDDLE + d.w / HEIGHT), 1.0));
}
