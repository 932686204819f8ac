// Takes the colour of a neighbouring frame, carried here along motion, into an average.
// Cost: 16 loads of colour and 100 operations.
#import shared/motion

#input average, motion, shares, theirs
#output target_image rgba32float

fn main(@builtin(global_invocation_id) id: vec3u) {
#insert gpu/carry_begin
    // Shares are those of known motions.
    let place = centre(id) + fetch(motion, 1u, pixel(id)).xy;
    let sum = sample_sharp_covered(theirs, 3u, place);
    let carried = unpremultiply(vec4f(sum.rgb, clamp(sum.a, 0.0, 1.0)));
    // Colours count by their coverage too.
    let alpha = own.a + (carried.a - own.a) * share;
    let weight = select(0.0, share * carried.a / alpha, alpha > LEAST_COVERAGE);
    textureStore(target_image, vec2i(id.xy), vec4f(own.rgb + (carried.rgb - own.rgb) * weight, alpha));
}
