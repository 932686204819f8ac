// One explicit step of a shock filter (6.3) by the upwind scheme of Osher and Sethian: each channel is
// dilated where its detector is negative and eroded where it is positive.
// Cost: six loads.
#import gpu/grid

struct Params {
    /// Time step, at most 1/2.
    time_step: f32,
    /// The sign of the detector is soft below 1 / steepness.
    steepness: f32,
}

#params
#input source, detector
#output target_image rgba32float

// By how much a neighbour lies on the side that the step goes to; where it is transparent it stands for
// the centre.
fn pull(p: vec2i, centre: vec3f, side: vec3f) -> vec3f {
    let v = fetch(source, 0u, p);
    return max(side * (v.rgb - centre) * v.a, vec3f(0.0));
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = pixel(id);
    let c = fetch(source, 0u, p);
    let speed = clamp(-params.steepness * fetch(detector, 1u, p).rgb, vec3f(-1.0), vec3f(1.0));
    let side = sign(speed);
    let left = pull(p - vec2i(1, 0), c.rgb, side);
    let right = pull(p + vec2i(1, 0), c.rgb, side);
    let up = pull(p - vec2i(0, 1), c.rgb, side);
    let down = pull(p + vec2i(0, 1), c.rgb, side);
    let slope = sqrt(left * left + right * right + up * up + down * down);
    textureStore(target_image, vec2i(id.xy), vec4f(c.rgb + params.time_step * speed * slope, c.a));
}
