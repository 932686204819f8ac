//! Repeatable randomness: a small generator and lattice noise that tiles.
//!
//! Everything is integer hashing, so the same seed draws the same scene on every machine.

use glam::{IVec2, Vec2};

/// Mixes 32 bits so that neighbouring inputs give unrelated outputs (the finaliser of MurmurHash3).
pub fn mix(mut bits: u32) -> u32 {
    bits ^= bits >> 16;
    bits = bits.wrapping_mul(0x85eb_ca6b);
    bits ^= bits >> 13;
    bits = bits.wrapping_mul(0xc2b2_ae35);
    bits ^ (bits >> 16)
}

/// A hash of a lattice point.
pub fn hash(point: IVec2, seed: u32) -> u32 {
    mix((point.x as u32).wrapping_mul(0x9e37_79b1) ^ mix((point.y as u32) ^ seed.wrapping_mul(0x27d4_eb2f)))
}

/// Maps a hash to [0, 1).
pub fn unit(hash: u32) -> f32 {
    (hash >> 8) as f32 / 16_777_216.0
}

/// A sequence of random numbers: a Weyl sequence pushed through [`mix`].
#[derive(Clone)]
pub struct Random(u32);

impl Random {
    /// Starts a sequence; different seeds give unrelated sequences.
    pub fn new(seed: u32) -> Self {
        Self(mix(seed ^ 0x5bd1_e995))
    }

    /// The next number in [0, 1).
    pub fn unit(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9);
        unit(mix(self.0))
    }

    /// The next number in [`low`, `high`).
    pub fn range(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }

    /// The next number in [-`size`, `size`).
    pub fn around(&mut self, size: f32) -> f32 {
        self.range(-size, size)
    }
}

/// The cubic Hermite step from 0 at `low` to 1 at `high`.
pub fn smoothstep(low: f32, high: f32, value: f32) -> f32 {
    let t = ((value - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// The point at `t` between the second and the third of four on a curve of Catmull and Rom.
pub fn catmull_rom([a, b, c, d]: [Vec2; 4], t: f32) -> Vec2 {
    b + ((c - a) + ((a * 2.0 - b * 5.0 + c * 4.0 - d) + ((b - c) * 3.0 + d - a) * t) * t) * (0.5 * t)
}

/// Linear interpolation.
pub fn lerp(from: f32, to: f32, t: f32) -> f32 {
    from + (to - from) * t
}

/// Value noise in [0, 1] that repeats every `period` lattice cells along both axes.
pub fn value_noise(point: Vec2, period: IVec2, seed: u32) -> f32 {
    let cell = point.floor();
    let t = point - cell;
    let t = t * t * (3.0 - 2.0 * t);
    let cell = cell.as_ivec2();
    let corner = |dx: i32, dy: i32| unit(hash((cell + IVec2::new(dx, dy)).rem_euclid(period), seed));
    let low = lerp(corner(0, 0), corner(1, 0), t.x);
    let high = lerp(corner(0, 1), corner(1, 1), t.x);
    lerp(low, high, t.y)
}

/// Octaves of value noise in [0, 1], over a texture coordinate in [0, 1]² that tiles.
pub fn fractal(uv: Vec2, period: i32, octaves: u32, seed: u32) -> f32 {
    fractal_stretched(uv, IVec2::splat(period), octaves, seed)
}

/// As [`fractal`], with a period for each axis: grain that runs in one direction.
pub fn fractal_stretched(uv: Vec2, period: IVec2, octaves: u32, seed: u32) -> f32 {
    let (mut sum, mut weight, mut total) = (0.0, 0.5, 0.0);
    let mut period = period;
    for octave in 0..octaves {
        sum += weight * value_noise(uv * period.as_vec2(), period, seed.wrapping_add(octave * 101));
        total += weight;
        weight *= 0.5;
        period *= 2;
    }
    sum / total
}

/// Result of [`cells`] at a point.
pub struct Cell {
    /// Distance to the border of the cell, in lattice cells.
    pub border: f32,
    /// A hash that names the cell.
    pub id: u32,
}

/// Cellular (Worley) noise over a texture coordinate in [0, 1]² that tiles; `jitter` in [0, 1]
/// moves the seed points away from the centres of a `period` x `period` lattice.
pub fn cells(uv: Vec2, period: i32, jitter: f32, seed: u32) -> Cell {
    let point = uv * period as f32;
    let base = point.floor().as_ivec2();
    let (mut nearest, mut second) = ((f32::MAX, Vec2::ZERO, 0), (f32::MAX, Vec2::ZERO));
    for dy in -1..=1 {
        for dx in -1..=1 {
            let lattice = base + IVec2::new(dx, dy);
            let id = hash(lattice.rem_euclid(IVec2::splat(period)), seed);
            let shift = Vec2::new(unit(id), unit(mix(id ^ 0x68bc_21eb))) - 0.5;
            let offset = point - (lattice.as_vec2() + 0.5 + shift * jitter);
            let distance = offset.length_squared();
            if distance < nearest.0 {
                second = (nearest.0, nearest.1);
                nearest = (distance, offset, id);
            } else if distance < second.0 {
                second = (distance, offset);
            }
        }
    }
    // The border between two seed points is their bisector.
    let across = nearest.1 - second.1;
    let border = (-(nearest.1 + second.1) * 0.5).dot(across) / across.length().max(1e-6);
    Cell { border: border.abs(), id: nearest.2 }
}
