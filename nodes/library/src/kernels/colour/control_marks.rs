//! Marks of a medium where a control map says how much of it there is: what they leave bare is raised to the factor of the
//! map's fourth channel, as if they were drawn that many times.
//!
//! Cost: a logarithm and two exponentials per pixel.

use crate::kernels::shared::control::factor;
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::math::Elementary;
use isophote_engine::{Class, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(control_marks {
    block: |simd, pass| |block| [repeated(
        block.read(simd, &pass.inputs[0]),
        block.read(simd, &pass.inputs[1])
    )],
    cost: |_| 50.0,
    tolerance: Tolerance::of_rounding(2e-6, 2e-5, "a logarithm times four, through an exponential"),
});

/// The share of the paper that marks cover, one channel, under a control map.
pub fn pass(plan: &mut PlanBuilder, marks: ImageId, control: ImageId) -> ImageId {
    plan.pass(&KERNEL, &[marks, control], &(), Class::Field, Support::Pixels(0))
}

#[inline(always)]
fn repeated<S: Simd>([marks]: [f32x8<S>; 1], control: [f32x8<S>; 4]) -> f32x8<S> {
    let (zero, one) = (f32x8::splat(marks.simd, 0.0), f32x8::splat(marks.simd, 1.0));
    let factor = factor(control[3]);
    let covered = one - ((one - marks).within(1e-6, 1.0).ln() * factor).exp();
    (!factor.simd_eq(one) & marks.simd_gt(zero)).select(covered, marks)
}
