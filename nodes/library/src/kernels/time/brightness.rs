//! Brightness of a colour over black, which optical flow compares: its luma, not below 0 and not above 4.
//!
//! Cost: 6 operations.

use crate::kernels::simd::pixels::map_pixels;
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Class, ImageId, PlanBuilder, Support, Tolerance};

/// Highlights beyond it would outweigh all else that moves.
const BRIGHTEST: f32 = 4.0;

crate::kernel!(brightness {
    cpu: |simd, pass, band| map_pixels(simd, pass, band, luma),
    cost: |_| 6.0,
    tolerance: Tolerance::of_rounding(1e-6, 1e-6, "a sum of three products"),
});

/// Adds the pass.
pub fn pass(plan: &mut PlanBuilder, color: ImageId) -> ImageId {
    plan.pass(&KERNEL, &[color], &(), Class::Field, Support::Pixels(0))
}

#[inline(always)]
fn luma<S: Simd>([r, g, b, a]: [f32x8<S>; 4]) -> [f32x8<S>; 1] {
    let luma = (r * 0.2126 + g * 0.7152 + b * 0.0722) * a;
    [luma.within(0.0f32, BRIGHTEST)]
}
