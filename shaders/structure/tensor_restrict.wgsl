// One level of the pyramid of valid tensors up: the mean of the valid among four (Listing 2.4).
// Cost: 4 loads.
#import gpu/grid

struct Params {
    /// A tensor is valid from this w on; below 0 all are.
    kept: f32,
}

#params
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
            let t = fetch(source, 0u, vec2i(x, y));
            if t.w >= params.kept {
                sum += t;
                count += 1.0;
            }
        }
    }
    textureStore(target_image, vec2i(id.xy), sum / max(count, 1.0));
}
