//! Brightness of a colour over black, which optical flow compares: its luma, not below 0 and not above 4.
//!
//! Cost: 6 operations.

use crate::kernels::simd::pixels::map_pixels;
use isophote_engine::fearless_simd::prelude::*;
use isophote_engine::{Class, ImageId, PlanBuilder, Support, Tolerance};

/// Highlights beyond it would outweigh all else that moves.
const BRIGHTEST: f32 = 4.0;

crate::kernel!(brightness {
    cpu: |simd, pass, band| map_pixels(
        simd,
        pass,
        band,
        #[inline(always)]
        |[r, g, b, a]: [_; 4]| [((r * 0.2126 + g * 0.7152 + b * 0.0722) * a).within(0.0f32, BRIGHTEST)],
    ),
    cost: |_| 6.0,
    tolerance: Tolerance::of_rounding(1e-6, 1e-6, "a sum of three products"),
});

/// Adds the pass.
pub fn pass(plan: &mut PlanBuilder, color: ImageId) -> ImageId {
    plan.pass(&KERNEL, &[color], &(), Class::Field, Support::Pixels(0))
}
