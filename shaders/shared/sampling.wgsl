#import gpu/grid

// Bilinear sampling by hand. Twin of kernels/shared/sampling.rs.
//
// Samplers are not used because their weights have eight bits of fraction on common hardware, too
// few for stream lines that add up many small steps; because filtering 32-bit floats is an optional
// feature of a device; and because the CPU twin must get the same numbers: the formula and the order
// of its operations are those of `sample_linear4` there.

// The four pixels around a position, as texels, and how far it lies from the first to the others.
struct Surroundings {
    near: vec2i,
    far: vec2i,
    f: vec2f,
}

// Of absolute position p in input `slot`, pixel centres at +0.5, clamped to the picture's edge. To clamp the position
// and the far pixel is as much as to clamp all four: beyond the edge they hold the same values.
fn surroundings(slot: u32, p: vec2f) -> Surroundings {
    let place = grid.inputs[slot];
    let last = place.zw - 1;
    let q = clamp(p - 0.5, vec2f(0.0), vec2f(last));
    // Conversions round towards zero, which is down here.
    let near = vec2i(q) - place.xy;
    return Surroundings(near, min(near + 1, last - place.xy), fract(q));
}

// The same of positions whose four pixels the picture is known to hold.
fn surroundings_inside(slot: u32, p: vec2f) -> Surroundings {
    let q = p - 0.5;
    let near = vec2i(q) - grid.inputs[slot].xy;
    return Surroundings(near, near + 1, fract(q));
}

// Four pixels interpolated: a and b above c and d.
fn bilinear(a: vec4f, b: vec4f, c: vec4f, d: vec4f, f: vec2f) -> vec4f {
    let top = a + (b - a) * f.x;
    let bottom = c + (d - c) * f.x;
    return top + (bottom - top) * f.y;
}

// The image among four pixels, interpolated.
fn sample_among(image: texture_2d<f32>, s: Surroundings) -> vec4f {
    let a = textureLoad(image, s.near, 0);
    let b = textureLoad(image, vec2i(s.far.x, s.near.y), 0);
    let c = textureLoad(image, vec2i(s.near.x, s.far.y), 0);
    let d = textureLoad(image, s.far, 0);
    return bilinear(a, b, c, d, s.f);
}

// Input `slot` at absolute position p, interpolated.
fn sample_linear(image: texture_2d<f32>, slot: u32, p: vec2f) -> vec4f {
    return sample_among(image, surroundings(slot, p));
}
