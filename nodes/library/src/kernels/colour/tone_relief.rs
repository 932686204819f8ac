//! Lightness of two Lab images beside each other: that of tones, and that of the relief that they rise from, the same smoothed
//! wide. Both as (L alpha, alpha), as `lightness` has it.
//!
//! Cost: two products a pixel.

use crate::kernels::simd::pixels::{for_blocks, write};
use isophote_engine::fearless_simd::{dispatch, f32x8};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(tone_relief {
    cpu: run,
    cost: |_| 4.0,
    tolerance: Tolerance::of_rounding(1e-5, 1e-6, "one product"),
});

/// Adds the pass.
pub fn pass(plan: &mut PlanBuilder, lab: ImageId, relief: ImageId) -> ImageId {
    plan.pass(&KERNEL, &[lab, relief], &(), Class::Colour, Support::Pixels(0))
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    dispatch!(pass.level, simd => for_blocks::<4>(band, #[inline(always)] |block, target| {
        let [l, _, _, alpha]: [f32x8<_>; 4] = block.read(simd, &pass.inputs[0]);
        let [around, _, _, cover]: [f32x8<_>; 4] = block.read(simd, &pass.inputs[1]);
        write([l * alpha, alpha, around * cover, cover], target);
    }));
}
