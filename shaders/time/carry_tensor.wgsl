// Takes the structure tensor of a neighbouring frame, carried here along motion and turned with it, into an average.
// Cost: five loads of motion, four of tensors and 60 operations.
#import shared/motion

#input average, motion, shares, theirs
#output target_image rgba32float

// The derivative of motion from its values before, at and after a pixel: the smaller one-sided difference, and none
// across borders of things.
fn derivative(before: vec2f, at: vec2f, after: vec2f) -> vec2f {
    let low = at - before;
    let high = after - at;
    let smaller = select(high, low, abs(low) < abs(high));
    return select(vec2f(0.0), smaller, abs(smaller) < vec2f(0.5));
}

fn main(@builtin(global_invocation_id) id: vec3u) {
#insert gpu/carry_begin
    let p = pixel(id);
    let at = fetch(motion, 1u, p).xy;
    let dx = derivative(fetch(motion, 1u, p - vec2i(1, 0)).xy, at, fetch(motion, 1u, p + vec2i(1, 0)).xy);
    let dy = derivative(fetch(motion, 1u, p - vec2i(0, 1)).xy, at, fetch(motion, 1u, p + vec2i(0, 1)).xy);
    // The Jacobian of the place there by the place here: columns (a, c) and (b, d).
    let a = 1.0 + dx.x;
    let c = dx.y;
    let b = dy.x;
    let d = 1.0 + dy.y;
    let t = sample_linear(theirs, 3u, centre(id) + at);
    // Gradients turn by its transpose.
    let e = a * a * t.x + 2.0 * a * c * t.y + c * c * t.z;
    let f = a * b * t.x + (a * d + b * c) * t.y + c * d * t.z;
    let g = b * b * t.x + 2.0 * b * d * t.y + d * d * t.z;
    textureStore(target_image, vec2i(id.xy), own + (vec4f(e, f, g, t.w) - own) * share);
}
