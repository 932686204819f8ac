#import gpu/grid
#import gpu/tap

// The pixels of a workgroup, for kernels that load their neighbours together.
//
// All invocations must reach every barrier. Those of edge workgroups that have no texel to write therefore
// go along, in the place of the nearest one that has: nothing is read that a pixel of the pass does not
// need, and a texture may end where the pass's support does. Only the store is left to `outside`.
// Workgroup memory is not cleared before: a kernel reads what it has written.

// Drivers that compute on the CPU read textures through its caches, and workgroup memory lane by lane: there
// `false` is several times faster. Every tap is then fetched, in the same order.
override shared_windows: bool = true;

// Absolute position of the workgroup's first pixel.
fn group_corner(id: vec3u) -> vec2i {
    return grid.origin + vec2i(id.xy & vec2u(~(GROUP_SIDE - 1u)));
}

// Columns and rows of the workgroup that have a texel to write, 1..GROUP_SIDE.
fn group_size(id: vec3u) -> vec2i {
    return min(grid.size - vec2i(id.xy & vec2u(~(GROUP_SIDE - 1u))), vec2i(i32(GROUP_SIDE)));
}

// The invocation's own place in the workgroup, for sharing out work.
fn group_local(id: vec3u) -> vec2i {
    return vec2i(id.xy & vec2u(GROUP_SIDE - 1u));
}

// Its number in the workgroup, from 0 on.
fn group_index(id: vec3u) -> u32 {
    let local = id.xy & vec2u(GROUP_SIDE - 1u);
    return local.y * GROUP_SIDE + local.x;
}

// Place in the workgroup of the pixel that the invocation computes.
fn group_seat(id: vec3u) -> vec2i {
    return min(group_local(id), group_size(id) - 1);
}

// Absolute position of that pixel.
fn group_pixel(id: vec3u) -> vec2i {
    return group_corner(id) + group_seat(id);
}
