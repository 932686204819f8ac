#import gpu/grid

// Bilinear sampling by hand. Twin of kernels/shared/sampling.rs.
//
// Samplers are not used because their weights have eight bits of fraction on common hardware, too
// few for stream lines that add up many small steps; because filtering 32-bit floats is an optional
// feature of a device; and because the CPU twin must get the same numbers: the formula and the order
// of its operations are those of `sample_linear4` there.

// Input `slot` at absolute position p, pixel centres at +0.5, clamped to the picture's edge.
fn sample_linear(image: texture_2d<f32>, slot: u32, p: vec2f) -> vec4f {
    let last = vec2f(grid.inputs[slot].zw);
    // Far outside, the conversion to integers would saturate: keep positions near the picture.
    let q = min(max(p - 0.5, vec2f(-2.0)), last + 2.0);
    let corner = floor(q);
    let f = q - corner;
    let i = vec2i(corner);
    let a = fetch(image, slot, i);
    let b = fetch(image, slot, i + vec2i(1, 0));
    let c = fetch(image, slot, i + vec2i(0, 1));
    let d = fetch(image, slot, i + vec2i(1, 1));
    let top = a + (b - a) * f.x;
    let bottom = c + (d - c) * f.x;
    return top + (bottom - top) * f.y;
}
