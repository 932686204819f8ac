// The derivatives that the variational refinement needs: x, y, z of the brightness, where z is from here to there,
// and of its gradient. Central differences; in levels of brightness. Cost: 14 loads.
#import gpu/grid

#input mean, difference
#output first_image rgba32float
#output second_image rgba32float

// Levels of brightness to 1.
const LEVELS = 255.0;

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = pixel(id);
    let origin = fetch(mean, 0u, p).x;
    let left = fetch(mean, 0u, p - vec2i(1, 0)).x;
    let right = fetch(mean, 0u, p + vec2i(1, 0)).x;
    let up = fetch(mean, 0u, p - vec2i(0, 1)).x;
    let down = fetch(mean, 0u, p + vec2i(0, 1)).x;
    let falling = fetch(mean, 0u, p + vec2i(1, 1)).x + fetch(mean, 0u, p - vec2i(1, 1)).x;
    let rising = fetch(mean, 0u, p + vec2i(1, -1)).x + fetch(mean, 0u, p + vec2i(-1, 1)).x;
    let z = fetch(difference, 1u, p).x;
    let xz = fetch(difference, 1u, p + vec2i(1, 0)).x - fetch(difference, 1u, p - vec2i(1, 0)).x;
    let yz = fetch(difference, 1u, p + vec2i(0, 1)).x - fetch(difference, 1u, p - vec2i(0, 1)).x;
    let xx = right - 2.0 * origin + left;
    let yy = down - 2.0 * origin + up;
    let first = vec4f(0.5 * (right - left), 0.5 * (down - up), z, xx);
    let second = vec4f(0.25 * (falling - rising), yy, 0.5 * xz, 0.5 * yz);
    textureStore(first_image, vec2i(id.xy), LEVELS * first);
    textureStore(second_image, vec2i(id.xy), LEVELS * second);
}
