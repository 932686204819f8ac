// The highest peak of noise among the pixels of a cell, from the four cells of the finer level: seeds of strokes lie where
// noise is highest, and move with it.
// Cost: 4 loads.
#import gpu/grid

struct Params {
    /// Cells of the finer level by which those of this one begin before the picture, 0 or 1.
    shift: vec2i,
    /// Factor on the noise's distance from its mean.
    gain: f32,
    /// Nonzero where the finer level is the noise itself.
    begin: u32,
}

#params
#input source
#output target_image rgba32float

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = 2 * pixel(id) - params.shift;
    // At the borders some children do not exist.
    let size = grid.inputs[0].zw;
    var best = vec4f(0.0, 0.0, -1e30, 0.0);
    for (var y = max(p.y, 0); y < min(p.y + 2, size.y); y++) {
        for (var x = max(p.x, 0); x < min(p.x + 2, size.x); x++) {
            let v = fetch(source, 0u, vec2i(x, y));
            let first = vec4f(f32(x) + 0.5, f32(y) + 0.5, (v.x - 0.5) * params.gain, 0.0);
            let peak = select(v, first, params.begin != 0u);
            if peak.z > best.z {
                best = peak;
            }
        }
    }
    textureStore(target_image, vec2i(id.xy), best);
}
