#import gpu/group

// The sampled weighting functions of shared/sampled_sectors, of shaders whose parameters hold them. Where pictures have
// 16-bit floats, gpu/sector_weights_half stands in the place of this text.

// Makes them ready; all invocations of a workgroup come by before any asks for one.
fn sector_weights_load(id: vec3u) {
}

// Those at a node.
fn sector_weights_at(node: u32) -> vec4f {
    return params.weights[node];
}
