// How much a neighbouring frame counts beside those before it, where its colour agrees.
// Cost: a bilinear sample of colour and 40 operations.
#import shared/motion

struct Params {
    /// Weight of the frame by its distance in time, 0..=1.
    gain: f32,
    /// log2(e) / (2 sigma^2) of the Gaussian over differences of colour, per unit squared.
    falloff: f32,
    /// Units of colour that a difference of alpha of 1 counts as.
    alpha: f32,
    /// 1 where the third input is a weight, 0 where it is anything.
    weighted: f32,
    /// 1 where the fourth input is the share and the total of the frame before, 0 for the first one.
    follows: f32,
}

#params
#input own, motion, weights, before, theirs
#output target_image rg32float

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    covered_begin(theirs);
    let step = fetch(motion, 1u, pixel(id)).xy;
    let known = is_known(step);
    let place = centre(id) + select(vec2f(0.0), step, known);
    let here = fetch(own, 0u, pixel(id));
    let there = unpremultiply(sample_covered(theirs, 4u, place));
    let difference = (here - there) * vec4f(1.0, 1.0, 1.0, params.alpha);
    let agreement = exp2(-params.falloff * dot(difference, difference));
    let guided = select(1.0, fetch(weights, 2u, pixel(id)).x, params.weighted > 0.0);
    let total = select(1.0, fetch(before, 3u, pixel(id)).y, params.follows > 0.0);
    let counts = known && is_inside(place, grid.inputs[4].zw);
    let weight = select(0.0, params.gain * agreement * guided, counts);
    let sum = total + weight;
    textureStore(target_image, vec2i(id.xy), vec4f(weight / sum, sum, 0.0, 0.0));
}
