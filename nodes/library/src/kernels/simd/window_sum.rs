//! Sums under symmetric windows on interleaved values, and the weights of Gaussian ones: what rows and
//! columns of all Gaussians share.
//!
//! A run of values is summed at once, so that the place of a tap is looked up once for all of them and
//! the sums stay in registers. The end of a row goes through the same operations in the same order.
//!
//! Cost: an addition and a multiply-add per value and pair of taps.

use isophote_engine::fearless_simd::{Simd, f32x16, prelude::*};

/// Entries of a Gaussian table, the centre included.
pub const GAUSSIAN_TAPS: usize = 256;

/// Largest radius of a Gaussian table, in pixels.
pub const GAUSSIAN_MAX_RADIUS: u32 = GAUSSIAN_TAPS as u32 - 1;

/// One half of a Gaussian, packed as the uniform block wants it: entry i is the weight at distance i.
pub type GaussianTable = [[f32; 4]; GAUSSIAN_TAPS / 4];

/// Radius at which a Gaussian of standard deviation `sigma` (pixels) is cut: ceil(cutoff sigma).
pub fn gaussian_radius(sigma: f32, cutoff: f32) -> u32 {
    ((cutoff * sigma).ceil().max(0.0) as u32).min(GAUSSIAN_MAX_RADIUS)
}

/// Weights of a Gaussian of standard deviation `sigma` at distances 0..=radius (2.21), normalised
/// by the sum of the kept weights (both sides).
pub fn gaussian_table(sigma: f32, radius: u32) -> GaussianTable {
    let mut table = [[0.0; 4]; GAUSSIAN_TAPS / 4];
    let sigma = f64::from(sigma).max(1e-4);
    let weight = |i: u32| (-f64::from(i * i) / (2.0 * sigma * sigma)).exp();
    let sum: f64 = weight(0) + 2.0 * (1..=radius).map(weight).sum::<f64>();
    for i in 0..=radius.min(GAUSSIAN_MAX_RADIUS) {
        table[i as usize / 4][i as usize % 4] = (weight(i) / sum) as f32;
    }
    table
}

/// Values that are summed at once.
pub const RUN: usize = 64;

/// Vectors of a run.
const VECTORS: usize = RUN / 16;

/// The weights of a table from the centre on, flat.
pub fn flat(table: &GaussianTable) -> [f32; GAUSSIAN_TAPS] {
    let mut weights = [0.0; GAUSSIAN_TAPS];
    weights.copy_from_slice(table.as_flattened());
    weights
}

/// Sums of up to [`RUN`] values: `tap(i)` are the values of tap `i`, 0..=2 `radius`, and `weight(i)` the
/// weights at distance `i`.
#[inline(always)]
pub fn sum<'s, S: Simd>(
    simd: S,
    radius: usize,
    weight: impl Fn(usize) -> f32x16<S>,
    tap: impl Fn(usize) -> &'s [f32],
    target: &mut [f32],
) {
    if target.len() == RUN {
        let mut sums = [f32x16::splat(simd, 0.0); VECTORS];
        let (centre, middle) = (weight(0), &tap(radius)[..RUN]);
        for k in 0..VECTORS {
            sums[k] = load(simd, middle, k) * centre;
        }
        for i in 1..=radius {
            let weight = weight(i);
            let (before, after) = (&tap(radius - i)[..RUN], &tap(radius + i)[..RUN]);
            for k in 0..VECTORS {
                sums[k] = (load(simd, before, k) + load(simd, after, k)).mul_add(weight, sums[k]);
            }
        }
        for k in 0..VECTORS {
            sums[k].store_slice(&mut target[16 * k..16 * k + 16]);
        }
        return;
    }
    for (k, target) in target.chunks_mut(16).enumerate() {
        let mut sum = part(simd, tap(radius), k, target.len()) * weight(0);
        for i in 1..=radius {
            let (before, after) = (tap(radius - i), tap(radius + i));
            let both = part(simd, before, k, target.len()) + part(simd, after, k, target.len());
            sum = both.mul_add(weight(i), sum);
        }
        target.copy_from_slice(&sum.to_array()[..target.len()]);
    }
}

/// Vector `k` of some values.
#[inline(always)]
fn load<S: Simd>(simd: S, values: &[f32], k: usize) -> f32x16<S> {
    f32x16::from_slice(simd, &values[16 * k..16 * k + 16])
}

/// The first `len` values of vector `k`, padded with zeros.
#[inline(always)]
fn part<S: Simd>(simd: S, values: &[f32], k: usize, len: usize) -> f32x16<S> {
    let mut block = [0.0; 16];
    block[..len].copy_from_slice(&values[16 * k..16 * k + len]);
    f32x16::simd_from(simd, block)
}
