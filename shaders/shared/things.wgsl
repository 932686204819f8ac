#import shared/breaks

// Things of a pixel by a table of rules. Twin of kernels/shared/things.rs.

// Inputs that there are, as bits.
const HAS_NUMBERS: u32 = 1u;
const HAS_NAMES: u32 = 2u;

// Share of a pixel, 0..=1, whose things an entry of a table is for: first and last number of objects or, where z is not 0, the id of a
// name. A Cryptomatte has two things of a pixel: ids in x and z, and how much of it they cover in y and w.
fn thing_share(entry: vec4f, number: f32, matte: vec4f, reads: u32) -> f32 {
    if entry.z > 0.0 {
        let shares = select(vec2f(0.0), matte.yw, vec2<bool>(is_finite(matte.y), is_finite(matte.w)));
        let own = select(vec2f(0.0), shares, matte.xz == vec2f(entry.x));
        return select(0.0, clamp(own.x + own.y, 0.0, 1.0), (reads & HAS_NAMES) > 0u);
    }
    let known = known_id(number);
    let is_meant = known >= entry.x && known <= entry.y && (reads & HAS_NUMBERS) > 0u;
    return select(0.0, 1.0, is_meant);
}
