// The footprint of pixels, smoothed over their own surface.
// Cost: 26 loads and about 200 operations.
#import shared/rest_position
#import gpu/grid

#input points, footprints
#output target_image r32float

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = pixel(id);
    let own = fetch(points, 0u, p);
    if !is_at_rest(own) {
        textureStore(target_image, vec2i(id.xy), vec4f(NO_FOOTPRINT));
        return;
    }
    let longest = fetch(footprints, 1u, p).y;
    let is_known = has_footprint(longest);
    let pace = exp2(2.0 * select(0.0, longest, is_known));
    // By squared distance: a Gaussian of a standard deviation of 1.5 pixels.
    var shares = array<f32, 5>(1.0, 0.8007, 0.6412, 0.0, 0.4111);
    var sum = 0.0;
    var weights = 0.0;
    for (var j = -2; j <= 2; j++) {
        for (var i = -2; i <= 2; i++) {
            let distance = i * i + j * j;
            if distance > 4 {
                continue;
            }
            let there = fetch(points, 0u, p + vec2i(i, j));
            let footprint = fetch(footprints, 1u, p + vec2i(i, j)).x;
            if !is_at_rest(there) || !has_footprint(footprint) {
                continue;
            }
            // Points of one surface are no farther apart than pixels can be; others are of another one.
            let apart = there.xyz - own.xyz;
            let most = pace * f32(max(distance, 1));
            let far = min(dot(apart, apart), 16.0 * most) / most;
            let alike = select(1.0, clamp(2.0 - 0.25 * far, 0.0, 1.0), is_known);
            let weight = shares[distance] * alike;
            sum += weight * footprint;
            weights += weight;
        }
    }
    let mean = select(NO_FOOTPRINT, sum / max(weights, 1e-6), weights > 1e-6);
    textureStore(target_image, vec2i(id.xy), vec4f(mean, 0.0, 0.0, 0.0));
}
