//! Lightness and its square for the local deviation, as sums that any linear filter may average: (L alpha, L^2 alpha, alpha).
//! One highlight must not count as the contrast of all that is around it, so that lightness is bounded.
//!
//! Cost: a division and three multiplications per pixel.

use crate::kernels::shared::coverage::LEAST_COVERAGE;
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Class, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(lightness_moments {
    block: |simd, pass| |block| moments(block.read(simd, &pass.inputs[0])),
    cost: |_| 8.0,
    tolerance: Tolerance::of_rounding(1e-6, 2e-6, "a division and three multiplications"),
});

/// Lightness that counts at most, units of L: a little above paper white.
const LARGEST: f32 = 120.0;

/// (L alpha, L^2 alpha, alpha, 1) of (L alpha, alpha), L bounded.
pub fn pass(plan: &mut PlanBuilder, lightness: ImageId) -> ImageId {
    plan.pass(&KERNEL, &[lightness], &(), Class::Field, Support::Pixels(0))
}

#[inline(always)]
fn moments<S: Simd>([v, alpha]: [f32x8<S>; 2]) -> [f32x8<S>; 4] {
    let one = f32x8::splat(v.simd, 1.0);
    let l = (v / alpha.simd_gt(LEAST_COVERAGE).select(alpha, one)).within(0.0, LARGEST);
    [l * alpha, l * l * alpha, alpha, one]
}
