// Densification (Kroeger et al. 2016, eq. 3): the mean of the motions of the four patches that hold a pixel, each the
// less the more the brightness differs that it takes the pixel to. Cost: 21 loads.
#import gpu/grid

#input here, there, patches
#output target_image rg32float

// Levels of brightness to 1; differences of one level or less count alike.
const LEVELS = 255.0;

fn brightness(p: vec2i, motion: vec2f) -> f32 {
    let whole = floor(motion);
    let share = motion - whole;
    let first = p + vec2i(whole);
    let a = fetch(there, 1u, first).x;
    let b = fetch(there, 1u, first + vec2i(1, 0)).x;
    let c = fetch(there, 1u, first + vec2i(0, 1)).x;
    let d = fetch(there, 1u, first + vec2i(1, 1)).x;
    let top = a + (b - a) * share.x;
    let bottom = c + (d - c) * share.x;
    return top + (bottom - top) * share.y;
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = pixel(id);
    let origin = fetch(here, 0u, p).x;
    // Patches hold the pixels 4 i - 2 to 4 i + 5.
    let first = (p - 2) >> vec2u(2u);
    var sum = vec2f(0.0);
    var weights = 0.0;
    for (var i = 0; i < 4; i++) {
        let motion = fetch(patches, 2u, first + vec2i(i & 1, i >> 1u)).xy;
        let weight = 1.0 / max(1.0, LEVELS * abs(brightness(p, motion) - origin));
        sum += weight * motion;
        weights += weight;
    }
    textureStore(target_image, vec2i(id.xy), vec4f(sum / weights, 0.0, 0.0));
}
