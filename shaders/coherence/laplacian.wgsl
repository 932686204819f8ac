// The Laplacian of each colour channel, by differences to the four neighbours: where it is negative lies
// the zone of a maximum (6.3).
// Cost: five loads.
#import gpu/grid

#input source
#output target_image rgba32float

// By how much a neighbour exceeds the centre; where it is transparent it stands for the centre.
fn excess(p: vec2i, centre: vec3f) -> vec3f {
    let v = fetch(source, 0u, p);
    return (v.rgb - centre) * v.a;
}

fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id) {
        return;
    }
    let p = pixel(id);
    let c = fetch(source, 0u, p);
    let across = excess(p - vec2i(1, 0), c.rgb) + excess(p + vec2i(1, 0), c.rgb);
    let along = excess(p - vec2i(0, 1), c.rgb) + excess(p + vec2i(0, 1), c.rgb);
    textureStore(target_image, vec2i(id.xy), vec4f(across + along, 0.0));
}
