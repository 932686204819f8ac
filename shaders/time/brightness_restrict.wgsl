// Brightness at half the resolution: the mean of four pixels. At odd sizes the last ones, clamped, count twice,
// which leaves the mean of those that exist. Cost: 4 loads.
#import gpu/grid

#input source
#output target_image r32float

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = 2 * pixel(id);
    let upper = fetch(source, 0u, p).x + fetch(source, 0u, p + vec2i(1, 0)).x;
    let lower = fetch(source, 0u, p + vec2i(0, 1)).x + fetch(source, 0u, p + vec2i(1, 1)).x;
    textureStore(target_image, vec2i(id.xy), vec4f((upper + lower) * 0.25));
}
