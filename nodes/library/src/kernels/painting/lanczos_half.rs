//! One level of a colour pyramid up, ceil(n / 2) pixels on a side, by Lanczos resampling of three lobes
//! (§ 5.5.1).
//!
//! If asked for, values stay within those under the main lobe: the side lobes draw dark rings around highlights.
//! If coverage is partial, their negative weights could outweigh the rest, and the mean of the four
//! pixels below takes over. Rows are resampled first, each once.
//!
//! Cost: 36 multiply-adds and 60 operations on four channels per pixel of the coarser level. The shader takes
//! 144 multiply-adds, through workgroup memory: 11 loads.

pub use crate::kernels::shaders::lanczos_half::Params;
use isophote_engine::fearless_simd::{Simd, f32x4, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};
use std::f64::consts::PI;

crate::kernel!(lanczos_half {
    cpu: |simd, pass, params, band| resample(simd, pass, &params, band),
    cost: |_| 400.0,
    tolerance: Tolerance::of_rounding(1e-5, 2e-5, "sums of 144 products of either sign in another order"),
});

/// Adds the pass: from the image's level to the next coarser one; `limited` to the range of the pixels under the
/// main lobe.
pub fn pass(plan: &mut PlanBuilder, color: ImageId, limited: bool) -> ImageId {
    let lanczos = |d: f64| (PI * d).sin() * (PI * d / 3.0).sin() * 3.0 / (PI * PI * d * d);
    // Two pixels of this level are one of the next.
    let weights: [f64; 6] = std::array::from_fn(|i| lanczos((i as f64 + 0.5) / 2.0));
    let sum = 2.0 * weights.iter().sum::<f64>();
    let [a, b, c, d, e, f] = weights.map(|w| (w / sum) as f32);
    let params = Params {
        near: [a, b, c, d],
        far: [e, f, 0.0, 0.0],
        limited: limited.into(),
        padding: Default::default(),
    };
    let level = plan.desc(color).level + 1;
    plan.pass_at(&KERNEL, &[color], &params, &[Class::Colour], Support::Pixels(5), level)
}

/// A row of the finer level, resampled: per pixel of the coarser one the sum, least and greatest colour
/// under the main lobe, and the sum of the two pixels below.
type Row = Vec<[[f32; 4]; 4]>;

#[inline(always)]
fn resample<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, band: &mut Band<'_>) {
    let [a, b, c, d] = params.near;
    let [e, f, ..] = params.far;
    let lobes = [f, e, d, c, b, a, a, b, c, d, e, f];
    let window = band.window;
    let mut rows: [Row; 12] = Default::default();
    let (mut scratch, mut covered) = (Vec::new(), Vec::new());
    for y in window.y0..window.y1 {
        // Two new rows for each row of the coarser level; all twelve for the first.
        let first = if y == window.y0 { -5 } else { 5 };
        for j in first..=6 {
            let fine = 2 * y + j;
            let source = pass.inputs[0].padded_row(fine, 2 * window.x0 - 5, 2 * window.x1 + 5, &mut scratch);
            row(simd, source, &lobes, &mut covered, &mut rows[fine.rem_euclid(12) as usize]);
        }
        for (x, target) in band.row_mut(0, y).chunks_exact_mut(4).enumerate() {
            let zero = f32x4::splat(simd, 0.0);
            let (mut sharp, mut mean) = (zero, zero);
            let (mut least, mut most) = (f32x4::splat(simd, 3e38), f32x4::splat(simd, -3e38));
            for (lobe, j) in lobes.iter().zip(-5..) {
                let [sum, low, high, below] = &rows[(2 * y + j).rem_euclid(12) as usize][x];
                sharp = f32x4::splat(simd, *lobe).mul_add(f32x4::from_slice(simd, sum), sharp);
                if (-1..=2).contains(&j) {
                    least = least.at_most(f32x4::from_slice(simd, low));
                    most = most.at_least(f32x4::from_slice(simd, high));
                }
                if (0..=1).contains(&j) {
                    mean += f32x4::from_slice(simd, below) * 0.25;
                }
            }
            let (sharp_alpha, alpha) = (sharp.to_array()[3], mean.to_array()[3]);
            let below = mean / alpha.max(1e-6);
            // Not `clamp`: without any coverage the bounds are exchanged.
            let mut resampled = sharp / sharp_alpha.max(0.25);
            if params.limited != 0 {
                resampled = resampled.within(least, most);
            }
            let share = (4.0 * sharp_alpha.min(alpha) - 3.0).clamp(0.0, 1.0);
            let value = (resampled - below).mul_add(f32x4::splat(simd, share), below);
            value.store_slice(target);
            target[3] = alpha;
        }
    }
}

#[inline(always)]
fn row<S: Simd>(simd: S, source: &[f32], lobes: &[f32; 12], covered: &mut Vec<f32>, out: &mut Row) {
    covered.clear();
    for p in source.chunks_exact(4) {
        covered.extend_from_slice(&[p[0] * p[3], p[1] * p[3], p[2] * p[3], p[3]]);
    }
    out.clear();
    for (window, plain) in covered.windows(48).step_by(8).zip(source.windows(48).step_by(8)) {
        let zero = f32x4::splat(simd, 0.0);
        let (mut sum, mut below) = (zero, zero);
        let (mut least, mut most) = (f32x4::splat(simd, 3e38), f32x4::splat(simd, -3e38));
        for (i, lobe) in lobes.iter().enumerate() {
            let value = f32x4::from_slice(simd, &window[4 * i..4 * i + 4]);
            sum = f32x4::splat(simd, *lobe).mul_add(value, sum);
            if (4..8).contains(&i) && plain[4 * i + 3] > 0.0 {
                let colour = f32x4::from_slice(simd, &plain[4 * i..4 * i + 4]);
                least = least.at_most(colour);
                most = most.at_least(colour);
            }
            if (5..7).contains(&i) {
                below += value;
            }
        }
        out.push([sum.to_array(), least.to_array(), most.to_array(), below.to_array()]);
    }
}
