// What a motion field makes of the other picture: the mean of a pixel's brightness and that of the place it moves
// to, and their difference, that there less that here. Cost: 6 loads.
#import shared/sampling

#input here, there, motion
#output mean_image r32float
#output difference_image r32float

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = pixel(id);
    let origin = fetch(here, 0u, p).x;
    let moved = sample_linear(there, 1u, centre(id) + fetch(motion, 2u, p).xy).x;
    textureStore(mean_image, vec2i(id.xy), vec4f((origin + moved) * 0.5));
    textureStore(difference_image, vec2i(id.xy), vec4f(moved - origin));
}
