//! The footprint of pixels, smoothed over their own surface: the mean of the logarithms around, each as far as its point
//! may lie on the same surface. A mark is as large as the footprint says, and must not flicker where that is found
//! between leaves.
//!
//! Cost: 26 loads and about 200 operations.

use crate::kernels::shared::motion::beside;
use crate::kernels::shared::rest_position::{NO_FOOTPRINT, has_footprint, is_at_rest};
use crate::kernels::simd::pixels::{Block, pixels_beside};
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::math::Elementary;
use isophote_engine::{Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(rest_scale {
    block: |simd, pass| |block| [smoothed(simd, pass, block)],
    cost: |_| 260.0,
    tolerance: Tolerance {
        absolute: 1e-4,
        relative: 1e-5,
        outliers: 1e-3,
        reason: "a mean of 13 values; a neighbour that is just too far to count may be so for one twin only",
    },
});

/// By squared distance: a Gaussian of a standard deviation of 1.5 pixels.
const SHARES: [f32; 5] = [1.0, 0.8007, 0.6412, 0.0, 0.4111];

/// Logarithm, to base 2, of the mean width of a pixel on the object, smoothed, of `points` and their
/// [footprints](super::rest_footprint); [`NO_FOOTPRINT`] where there is no object.
pub fn pass(plan: &mut PlanBuilder, points: ImageId, footprints: ImageId) -> ImageId {
    plan.pass(&KERNEL, &[points, footprints], &(), Class::Field, Support::Pixels(2))
}

#[inline(always)]
fn smoothed<S: Simd>(simd: S, pass: &CpuPass<'_>, block: Block) -> f32x8<S> {
    let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
    let none = f32x8::splat(simd, NO_FOOTPRINT);
    let own: [f32x8<S>; 4] = block.read(simd, &pass.inputs[0]);
    let is_here = is_at_rest(own);
    if !is_here.any_true() {
        return none;
    }
    let [_, longest]: [f32x8<S>; 2] = block.read(simd, &pass.inputs[1]);
    let is_known = has_footprint(longest);
    let pace = (is_known.select(longest, zero) * 2.0).exp2();
    let (mut sum, mut weights) = (zero, zero);
    for j in -2..=2_i32 {
        for i in -2..=2_i32 {
            let distance = (i * i + j * j) as usize;
            if distance >= SHARES.len() {
                continue;
            }
            let there = pixels_beside(simd, &pass.inputs[0], block, [i, j]);
            let [footprint, _] = beside(simd, &pass.inputs[1], block, [i, j]);
            let counts = is_at_rest(there) & has_footprint(footprint) & is_here;
            // Points of one surface are no farther apart than pixels can be; others are of another one.
            let mut apart = [zero; 3];
            for c in 0..3 {
                apart[c] = counts.select(there[c] - own[c], zero);
            }
            let squared = apart[2].mul_add(apart[2], apart[1].mul_add(apart[1], apart[0] * apart[0]));
            let most = pace * distance.max(1) as f32;
            let far = squared.at_most(most * 16.0) / most;
            let alike = is_known.select((far * -0.25 + 2.0).within(zero, one), one);
            let weight = counts.select(alike * SHARES[distance], zero);
            sum = weight.mul_add(counts.select(footprint, zero), sum);
            weights += weight;
        }
    }
    (is_here & weights.simd_gt(1e-6)).select(sum / weights.at_least(1e-6), none)
}
