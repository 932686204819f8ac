// The second derivative of each colour channel along the major eigenvector, by central differences
// (thesis § 6.4.2): where it is negative lies the zone of a maximum.
// Cost: ten loads.
#import gpu/grid
#import shared/tensor

#input source, tensors
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
    let c = fetch(source, 0u, p).rgb;
    let tensor = fetch(tensors, 1u, p);
    let n = tensor_axis((tensor.x - tensor.z) * 0.5, tensor.y).major;
    let xx = excess(p - vec2i(1, 0), c) + excess(p + vec2i(1, 0), c);
    let yy = excess(p - vec2i(0, 1), c) + excess(p + vec2i(0, 1), c);
    let rising = excess(p + vec2i(1, 1), c) + excess(p - vec2i(1, 1), c);
    let falling = excess(p + vec2i(1, -1), c) + excess(p + vec2i(-1, 1), c);
    let xy = 0.25 * (rising - falling);
    let second = n.x * n.x * xx + 2.0 * n.x * n.y * xy + n.y * n.y * yy;
    textureStore(target_image, vec2i(id.xy), vec4f(second, 0.0));
}
