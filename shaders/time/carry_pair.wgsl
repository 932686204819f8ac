// Takes a value of a neighbouring frame, carried here along motion, into an average: the value times coverage, and
// coverage.
// Cost: 16 loads and 60 operations.
#import shared/motion

#input average, motion, shares, theirs
#output target_image rg32float

fn main(@builtin(global_invocation_id) id: vec3u) {
#insert gpu/carry_begin
    // Shares are those of known motions.
    let place = centre(id) + fetch(motion, 1u, pixel(id)).xy;
    let carried = sample_sharp(theirs, 3u, place).xy;
    textureStore(target_image, vec2i(id.xy), vec4f(own.xy + (carried - own.xy) * share, 0.0, 0.0));
}
