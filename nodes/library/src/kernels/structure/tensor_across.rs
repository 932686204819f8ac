//! Tensors turned by a right angle, whose stream lines lead across the form instead of along it: E and G change places,
//! and F its sign.
//!
//! Cost: nothing beside memory.

use crate::kernels::simd::pixels::{for_blocks, write};
use isophote_engine::fearless_simd::{dispatch, f32x8};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(tensor_across {
    cpu: run,
    cost: |_| 1.0,
    tolerance: Tolerance::of_rounding(0.0, 0.0, "numbers change places"),
});

/// Adds the pass.
pub fn pass(plan: &mut PlanBuilder, tensors: ImageId) -> ImageId {
    plan.pass(&KERNEL, &[tensors], &(), Class::Field, Support::Pixels(0))
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    dispatch!(pass.level, simd => for_blocks::<4>(band, #[inline(always)] |block, target| {
        let [e, f, g, w]: [f32x8<_>; 4] = block.read(simd, &pass.inputs[0]);
        write([g, -f, e, w], target);
    }));
}
