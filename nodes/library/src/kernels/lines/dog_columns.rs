//! Columns of two Gaussians at once, their difference and its threshold: the second half of the
//! isotropic extended difference of Gaussians (4.7-4.10).
//!
//! Cost: one multiply-add per tap and value (four values a pixel), radius + 1 taps; two divisions
//! and the threshold. Four interleaved pixels to a vector.

use crate::kernels::blocks::{for_blocks, write1};
use crate::kernels::edge_threshold::{LEAST_COVERAGE, Xdog, dog_response, edge_threshold, edge_uncovered};
use crate::kernels::lines::dog_rows;
use crate::kernels::support::GaussianTable;
use isophote_engine::fearless_simd::{Simd, dispatch, f32x8, f32x16, prelude::*};
use isophote_engine::math::load4;
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::params! {
    /// Uniform block.
    pub struct Params for dog_columns {
        /// Taps on each side of the centre.
        pub radius: i32,
        /// [`Threshold`](crate::kernels::edge_threshold::Threshold) as a number.
        pub threshold: u32,
        /// Weight of the smoothed lightness.
        pub base: f32,
        /// Weight of the difference of Gaussians.
        pub edge: f32,
        /// Response from which on there is no line.
        pub epsilon: f32,
        /// Steepness of the ramp.
        pub phi: f32,
        /// Not used.
        pub reserved_pair: [i32; 2],
        /// Weights at distance 0, 1, ... for standard deviation sigma.
        pub narrow: GaussianTable,
        /// Weights for standard deviation k sigma.
        pub wide: GaussianTable,
    }
}

crate::kernel!(dog_columns {
    cpu: run,
    cost: |params| {
        let p: Params = bytemuck::pod_read_unaligned(params);
        4.0 * (f64::from(p.radius) + 1.0) + 25.0
    },
    tolerance: Tolerance {
        absolute: 2e-3,
        relative: 1e-5,
        outliers: 2e-3,
        reason: "rounding of L (up to 5e-5, more in HDR) times the weight of the difference and phi; \
                 a binary threshold may go the other way on the last bit",
    },
});

/// The edge image of (L alpha, alpha): difference of Gaussians of standard deviations `sigma` and
/// `k` `sigma` pixels, weighted and thresholded as `xdog` says.
pub fn edges(plan: &mut PlanBuilder, lightness: ImageId, sigma: f32, k: f32, xdog: &Xdog) -> ImageId {
    let rows = dog_rows::rows(plan, lightness, sigma, k);
    let (radius, narrow, wide) = dog_rows::tables(sigma, k);
    let params = Params {
        radius: radius as i32,
        threshold: xdog.threshold as u32,
        base: xdog.base,
        edge: xdog.edge,
        epsilon: xdog.epsilon,
        phi: xdog.phi,
        reserved_pair: [0; 2],
        narrow,
        wide,
    };
    plan.pass(&KERNEL, &[rows], &params, Class::Field, Support::Pixels(radius))
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    dispatch!(pass.level, simd => columns(simd, pass, &params, band));
}

#[inline(always)]
fn columns<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, band: &mut Band<'_>) {
    let view = &pass.inputs[0];
    let r = params.radius;
    for_blocks::<1>(band, #[inline(always)] |block, target| {
        let mut sums = [0.0; 32];
        let values = 4 * block.len;
        let row = |dy: i32| {
            let at = view.offset(block.x, block.y + dy);
            &view.data()[at..at + values]
        };
        for (half, sum) in sums.chunks_exact_mut(16).enumerate() {
            let v = 16 * half;
            if v + 16 <= values {
                let tap = smooth(
                    simd,
                    params,
                    #[inline(always)]
                    |dy| f32x16::from_slice(simd, &row(dy)[v..v + 16]),
                );
                tap.store_slice(sum);
            } else if v < values {
                let tap = smooth(
                    simd,
                    params,
                    #[inline(always)]
                    |dy| {
                        let mut part = [0.0; 16];
                        part[..values - v].copy_from_slice(&row(dy)[v..]);
                        f32x16::simd_from(simd, part)
                    },
                );
                tap.store_slice(sum);
            }
        }
        let [nl, na, wl, wa]: [f32x8<S>; 4] = load4(simd, &sums);
        let one = f32x8::splat(simd, 1.0);
        let covered = na.min(wa).simd_gt(LEAST_COVERAGE);
        let (na, wa) = (covered.select(na, one), covered.select(wa, one));
        let u = dog_response(nl / na, wl / wa, params.base, params.edge);
        let line = edge_threshold(u, params.threshold, params.epsilon, params.phi);
        write1(covered.select(line, f32x8::splat(simd, edge_uncovered(params.threshold))), target);
    });
    debug_assert!(r >= 0);
}

/// Four pixels (narrow L, narrow alpha, wide L, wide alpha) smoothed along y.
#[inline(always)]
fn smooth<S: Simd>(simd: S, params: &Params, tap: impl Fn(i32) -> f32x16<S>) -> f32x16<S> {
    let mut sum = tap(0) * weight(simd, params, 0);
    for i in 1..=params.radius {
        sum = (tap(-i) + tap(i)).mul_add(weight(simd, params, i as usize), sum);
    }
    sum
}

#[inline(always)]
fn weight<S: Simd>(simd: S, params: &Params, i: usize) -> f32x16<S> {
    let (n, w) = (params.narrow[i / 4][i % 4], params.wide[i / 4][i % 4]);
    f32x16::simd_from(simd, [n, n, w, w, n, n, w, w, n, n, w, w, n, n, w, w])
}
