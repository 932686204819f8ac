// A colour at half the resolution: the mean of four pixels by their coverage. Cost: 4 loads.
#import shared/coverage

#input source
#output target_image rgba32float

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = 2 * pixel(id);
    // At odd sizes the last children do not exist; the clamped ones would count twice.
    let size = grid.inputs[0].zw;
    var sum = vec4f(0.0);
    var count = 0.0;
    for (var y = p.y; y < min(p.y + 2, size.y); y++) {
        for (var x = p.x; x < min(p.x + 2, size.x); x++) {
            sum += fetch_covered(source, 0u, vec2i(x, y));
            count += 1.0;
        }
    }
    textureStore(target_image, vec2i(id.xy), vec4f(unpremultiply(sum).rgb, sum.a / count));
}
