//! Rows of two Gaussians at once, on lightness and coverage: the first half of the isotropic
//! difference of Gaussians (4.5, 4.7).
//!
//! Cost: two multiply-adds per tap and value, radius + 1 taps. Sixteen interleaved pixels at a time.
//! The shader reads its windows through workgroup memory, radius / 2 + 2 loads a pixel.

pub use crate::kernels::shaders::dog_rows::Params;
use crate::kernels::simd::window_sum::{GaussianTable, flat, gaussian_radius, gaussian_table};
use isophote_engine::fearless_simd::{Simd, f32x16, f64x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(dog_rows {
    cpu: |simd, pass, params, band| smooth(simd, pass, &params, band),
    cost: |p| 4.0 * (f64::from(p.radius) + 1.0),
    tolerance: Tolerance::of_rounding(
        2e-5,
        4e-6,
        "sums of up to 511 products in the same order; only fused multiply-adds differ"
    ),
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
pub fn pass(plan: &mut PlanBuilder, lightness: ImageId, sigma: f32, k: f32) -> ImageId {
    let (radius, narrow, wide) = tables(sigma, k);
    let params = Params { radius: radius as i32, padding: Default::default(), narrow, wide };
    plan.pass(&KERNEL, &[lightness], &params, Class::Field, Support::Row(radius))
}

/// Values that are summed at once: sixteen pixels.
const RUN: usize = 32;

#[inline(always)]
fn smooth<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, band: &mut Band<'_>) {
    let (mut scratch, mut end) = (Vec::new(), Vec::new());
    let (narrow, wide) = (flat(&params.narrow), flat(&params.wide));
    let window = band.window;
    // Tap i of a value lies 2 i values to either side of it.
    let reach = 4 * params.radius as usize;
    let weights = [&narrow[..=params.radius as usize], &wide[..=params.radius as usize]];
    for y in window.y0..window.y1 {
        let (x0, x1) = (window.x0 - params.radius, window.x1 + params.radius);
        let source = pass.inputs[0].padded_row(y, x0, x1, &mut scratch);
        for (n, target) in band.row_mut(0, y).chunks_mut(2 * RUN).enumerate() {
            let source = &source[RUN * n..];
            if target.len() == 2 * RUN {
                sum(simd, &source[..RUN + reach], weights, target);
            } else {
                // The end of a row goes through the same arithmetic.
                end.clear();
                end.extend_from_slice(source);
                end.resize(RUN + reach, 0.0);
                let mut block = [0.0; 2 * RUN];
                sum(simd, &end, weights, &mut block);
                target.copy_from_slice(&block[..target.len()]);
            }
        }
    }
}

/// Pixels (narrow L, narrow alpha, wide L, wide alpha) from (L, alpha) of them and of the taps to both sides.
#[inline(always)]
fn sum<S: Simd>(simd: S, source: &[f32], [narrow, wide]: [&[f32]; 2], target: &mut [f32]) {
    let wide = &wide[..narrow.len()];
    let first = source.len() - RUN;
    let mut sums = [[f32x16::splat(simd, 0.0); 2]; 2];
    let middle = &source[first / 2..first / 2 + RUN];
    for k in 0..2 {
        let value = f32x16::from_slice(simd, &middle[16 * k..16 * k + 16]);
        sums[k] = [value * narrow[0], value * wide[0]];
    }
    // A plain loop: adapters of iterators stay calls in code for wide vectors.
    for i in 1..narrow.len() {
        let (n, w) = (f32x16::splat(simd, narrow[i]), f32x16::splat(simd, wide[i]));
        let (before, after) = (&source[first / 2 - 2 * i..][..RUN], &source[first / 2 + 2 * i..][..RUN]);
        for k in 0..2 {
            let both = f32x16::from_slice(simd, &before[16 * k..16 * k + 16])
                + f32x16::from_slice(simd, &after[16 * k..16 * k + 16]);
            sums[k] = [both.mul_add(n, sums[k][0]), both.mul_add(w, sums[k][1])];
        }
    }
    for k in 0..2 {
        // (L, alpha) pairs move as one 64-bit value.
        let [narrow, wide] = sums[k];
        let (a, b) = narrow.bitcast::<f64x8<S>>().interleave(wide.bitcast::<f64x8<S>>());
        a.bitcast::<f32x16<S>>().store_slice(&mut target[32 * k..32 * k + 16]);
        b.bitcast::<f32x16<S>>().store_slice(&mut target[32 * k + 16..32 * k + 32]);
    }
}
