// gpu/sector_weights with the functions in workgroup memory, in 16 bits: neighbouring pixels ask for other nodes, and a
// uniform block answers such questions one after another.

const SECTOR_NODES: u32 = 946u;

var<workgroup> sector_weights: array<vec2u, SECTOR_NODES>;

fn sector_weights_load(id: vec3u) {
    if !shared_windows {
        return;
    }
    for (var node = group_index(id); node < SECTOR_NODES; node += GROUP_SIDE * GROUP_SIDE) {
        let w = params.weights[node];
        sector_weights[node] = vec2u(pack2x16float(w.xy), pack2x16float(w.zw));
    }
    workgroupBarrier();
}

fn sector_weights_at(node: u32) -> vec4f {
    if !shared_windows {
        return params.weights[node];
    }
    let w = sector_weights[node];
    return vec4f(unpack2x16float(w.x), unpack2x16float(w.y));
}
