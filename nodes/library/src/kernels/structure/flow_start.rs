//! The start of the edge tangent flow (§ 2.5): each pixel's gradient as the tensor n n^T of its unit
//! vector n, and its magnitude in place of w. For a colour, both are those of the multi-image gradient:
//! the major eigenvector and sqrt(lambda1) of the unsmoothed structure tensor.
//!
//! Cost: about 20 operations.

use crate::kernels::shared::tensor::axis;
use crate::kernels::simd::pixels::map_pixels;
use isophote_engine::fearless_simd::{dispatch, f32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(flow_start {
    cpu: run,
    cost: |_| 20.0,
    tolerance: Tolerance::of_rounding(
        4e-6,
        1e-5,
        "two square roots and a division, on a difference of squares"
    ),
});

/// Below this magnitude a gradient is what rounding left of a flat part.
const LEAST: f32 = 1e-6;

/// Adds the pass: unsmoothed tensor to unit tensor and magnitude.
pub fn pass(plan: &mut PlanBuilder, tensor: ImageId) -> ImageId {
    plan.pass(&KERNEL, &[tensor], &(), Class::Field, Support::Pixels(0))
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    dispatch!(pass.level, simd => map_pixels(simd, pass, band, #[inline(always)] |[e, f, g, _]| {
        let zero = f32x8::splat(simd, 0.0);
        let (radius, [x, y]) = axis((e - g) * 0.5, f);
        let magnitude = ((e + g) * 0.5 + radius).at_least(zero).sqrt();
        let none = magnitude.simd_lt(f32x8::splat(simd, LEAST));
        let (xx, xy, yy) = (x * x, x * y, y * y);
        [none.select(zero, xx), none.select(zero, xy), none.select(zero, yy), none.select(zero, magnitude)]
    }));
}
