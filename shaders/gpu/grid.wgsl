// Where the textures of a pass lie in the picture, and reading them by absolute position.
//
// A pass may run on a tile with its halo. Kernels therefore speak of absolute pixel positions, as
// their CPU twins do; only the functions below know where a texture's texel (0, 0) lies. The
// code that lowers a plan fills the block, `Grid` in nodes/engine/src/program.rs is its layout.

struct Grid {
    // Absolute position of texel (0, 0) of the outputs.
    origin: vec2i,
    // Texels to write.
    size: vec2i,
    // Size of the whole picture at the outputs' level.
    full: vec2i,
    // How far the first of several kernels reads around a pixel that a window of the others holds.
    halo: vec2i,
    // Per input: absolute position of texel (0, 0), and the whole picture's size at its level.
    inputs: array<vec4i, 6>,
}

@group(0) @binding(0) var<uniform> grid: Grid;

// True for the invocations of edge workgroups that have no texel to write.
fn outside(id: vec3u) -> bool {
    return any(vec2i(id.xy) >= grid.size);
}

// Absolute position of the output texel that the invocation writes.
fn pixel(id: vec3u) -> vec2i {
    return grid.origin + vec2i(id.xy);
}

// Absolute position of that texel's centre, in pixels of the outputs' level.
fn centre(id: vec3u) -> vec2f {
    return vec2f(pixel(id)) + 0.5;
}

// The pixel at absolute position p of input `slot` (0 is the texture at binding 2), clamped to the
// picture's edge. Missing channels read as 0, and alpha as 1.
fn fetch(image: texture_2d<f32>, slot: u32, p: vec2i) -> vec4f {
    let place = grid.inputs[slot];
    let inside = clamp(p, vec2i(0), place.zw - 1);
    return textureLoad(image, inside - place.xy, 0);
}
