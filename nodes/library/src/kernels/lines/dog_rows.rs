//! Rows of two Gaussians at once, on lightness and coverage: the first half of the isotropic
//! difference of Gaussians (4.5, 4.7).
//!
//! Cost: two multiply-adds per tap and value, radius + 1 taps. Eight interleaved pixels to a vector.

use crate::kernels::support::{GaussianTable, gaussian_radius, gaussian_table};
use isophote_engine::fearless_simd::{Simd, dispatch, f32x16, f64x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::params! {
    /// Uniform block.
    pub struct Params for dog_rows {
        /// Taps on each side of the centre.
        pub radius: i32,
        /// Not used.
        pub reserved: i32,
        /// Not used.
        pub reserved_pair: [i32; 2],
        /// Weights at distance 0, 1, ... for standard deviation sigma.
        pub narrow: GaussianTable,
        /// Weights for standard deviation k sigma.
        pub wide: GaussianTable,
    }
}

crate::kernel!(dog_rows {
    cpu: run,
    cost: |params| {
        let p: Params = bytemuck::pod_read_unaligned(params);
        4.0 * (f64::from(p.radius) + 1.0)
    },
    tolerance: Tolerance {
        absolute: 2e-5,
        relative: 4e-6,
        outliers: 0.0,
        reason: "sums of up to 511 products in the same order; only fused multiply-adds differ",
    },
});

/// Cut-off of both windows, in standard deviations of the wider Gaussian.
const CUTOFF: f32 = 3.0;

/// Radius and weights of a pair of Gaussians of standard deviations `sigma` and `k` `sigma` pixels.
pub fn tables(sigma: f32, k: f32) -> (u32, GaussianTable, GaussianTable) {
    let radius = gaussian_radius(k * sigma, CUTOFF);
    (radius, gaussian_table(sigma, radius), gaussian_table(k * sigma, radius))
}

/// Smooths the rows of (L alpha, alpha) by standard deviations `sigma` and `k` `sigma` pixels; gives
/// (L alpha, alpha) of the one and of the other.
pub fn rows(plan: &mut PlanBuilder, lightness: ImageId, sigma: f32, k: f32) -> ImageId {
    let (radius, narrow, wide) = tables(sigma, k);
    let params = Params { radius: radius as i32, reserved: 0, reserved_pair: [0; 2], narrow, wide };
    plan.pass(&KERNEL, &[lightness], &params, Class::Field, Support::Pixels(radius))
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    dispatch!(pass.level, simd => smooth(simd, pass, &params, band));
}

#[inline(always)]
fn smooth<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, band: &mut Band<'_>) {
    let mut scratch = Vec::new();
    let window = band.window;
    let r = params.radius as usize;
    for y in window.y0..window.y1 {
        let (x0, x1) = (window.x0 - params.radius, window.x1 + params.radius);
        let source = pass.inputs[0].padded_row(y, x0, x1, &mut scratch);
        for (i, target) in band.row_mut(0, y).chunks_mut(32).enumerate() {
            // Tap i of value v lies 2 i values to either side of 2 r + v.
            let first = 16 * i;
            if target.len() == 32 {
                let [a, b] = pair(
                    simd,
                    params,
                    #[inline(always)]
                    |tap| f32x16::from_slice(simd, &source[first + 2 * tap..][..16]),
                );
                a.store_slice(&mut target[..16]);
                b.store_slice(&mut target[16..]);
                continue;
            }
            let rest = target.len() / 2;
            let [a, b] = pair(
                simd,
                params,
                #[inline(always)]
                |tap| {
                    let mut block = [0.0; 16];
                    block[..rest].copy_from_slice(&source[first + 2 * tap..][..rest]);
                    f32x16::simd_from(simd, block)
                },
            );
            let mut block = [0.0; 32];
            a.store_slice(&mut block[..16]);
            b.store_slice(&mut block[16..]);
            target.copy_from_slice(&block[..target.len()]);
        }
        debug_assert!(source.len() == 2 * (window.width() as usize + 2 * r));
    }
}

/// Eight pixels (narrow L, narrow alpha, wide L, wide alpha); `tap(0)` is the leftmost.
#[inline(always)]
fn pair<S: Simd>(simd: S, params: &Params, tap: impl Fn(usize) -> f32x16<S>) -> [f32x16<S>; 2] {
    let r = params.radius as usize;
    let middle = tap(r);
    let mut narrow = middle * params.narrow[0][0];
    let mut wide = middle * params.wide[0][0];
    for i in 1..=r {
        let both = tap(r - i) + tap(r + i);
        narrow = both.mul_add(f32x16::splat(simd, params.narrow[i / 4][i % 4]), narrow);
        wide = both.mul_add(f32x16::splat(simd, params.wide[i / 4][i % 4]), wide);
    }
    // (L, alpha) pairs move as one 64-bit value.
    let (a, b) = narrow.bitcast::<f64x8<S>>().interleave(wide.bitcast::<f64x8<S>>());
    [a.bitcast(), b.bitcast()]
}
