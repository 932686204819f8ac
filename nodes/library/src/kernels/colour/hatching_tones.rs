//! Tones of hatching that a host gives: the share of each pixel that ink covers, a channel each. What is no number is paper.
//!
//! Cost: four comparisons and four subtractions per pixel.

use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Class, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(hatching_tones {
    block: |simd, pass| |block| covered(block.read(simd, &pass.inputs[0])),
    cost: |_| 12.0,
    tolerance: Tolerance::of_rounding(1e-6, 1e-6, "a subtraction"),
});

/// What ink covers of hatching, of which 1 is paper and 0 is ink.
pub fn pass(plan: &mut PlanBuilder, hatching: ImageId) -> ImageId {
    plan.pass(&KERNEL, &[hatching], &(), Class::Field, Support::Pixels(0))
}

#[inline(always)]
fn covered<S: Simd>(mut tones: [f32x8<S>; 4]) -> [f32x8<S>; 4] {
    let one = f32x8::splat(tones[0].simd, 1.0);
    for tone in &mut tones {
        *tone = one - tone.is_nan().select(one, tone.within(0.0, 1.0));
    }
    tones
}
