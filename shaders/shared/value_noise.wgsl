// Smooth noise from hashed cells: the texture of papers and paint. Twin of kernels/shared/value_noise.rs.

// A number in 0..1 that belongs to a cell.
fn value_hash(x: u32, y: u32) -> f32 {
    var h = (x * 0x9e3779b1u) ^ (y * 0x85ebca77u);
    h = (h ^ (h >> 15u)) * 0x2c1b3c6du;
    h = (h ^ (h >> 12u)) * 0x297a2d39u;
    h = h ^ (h >> 15u);
    return f32(h >> 8u) * 5.9604645e-8;
}

// Smooth noise in 0..1 with cells of one unit.
fn value_noise(p: vec2f, seed: u32) -> f32 {
    let cell = floor(p);
    let f = p - cell;
    let s = f * f * (3.0 - 2.0 * f);
    let x = u32(i32(cell.x)) + seed;
    let y = u32(i32(cell.y));
    let top = mix(value_hash(x, y), value_hash(x + 1u, y), s.x);
    let bottom = mix(value_hash(x, y + 1u), value_hash(x + 1u, y + 1u), s.x);
    return mix(top, bottom, s.y);
}
