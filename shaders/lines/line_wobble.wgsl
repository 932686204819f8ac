// Moves lines a little along two fields of noise, one for each axis, so that they waver as a hand's do.
// Cost: 18 loads and about 60 operations.
#import shared/motion

struct Params {
    /// Farthest that a line is fetched from on each axis, pixels.
    amount: f32,
    /// Pixels per unit of the noise.
    gain: f32,
}

#params
#input edges, along_x, along_y
#output target_image r32float

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let noise = vec2f(fetch(along_x, 1u, pixel(id)).x, fetch(along_y, 2u, pixel(id)).x);
    let farthest = vec2f(params.amount);
    let moved = clamp((noise - 0.5) * params.gain, -farthest, farthest);
    // A sharp interpolation overshoots.
    let edge = clamp(sample_sharp(edges, 0u, centre(id) + moved).x, 0.0, 1.0);
    textureStore(target_image, vec2i(id.xy), vec4f(edge));
}
