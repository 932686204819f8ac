// Takes a value of 0..1 of a neighbouring frame, carried here along motion, into an average.
// Cost: 16 loads and 60 operations.
#import shared/motion

#input average, motion, shares, theirs
#output target_image r32float

fn main(@builtin(global_invocation_id) id: vec3u) {
#insert gpu/carry_begin
    // Shares are those of known motions.
    let place = centre(id) + fetch(motion, 1u, pixel(id)).xy;
    // A sharp interpolation overshoots.
    let carried = clamp(sample_sharp(theirs, 3u, place).x, 0.0, 1.0);
    textureStore(target_image, vec2i(id.xy), vec4f(own.x + (carried - own.x) * share));
}
