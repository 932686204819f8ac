//! Orientation of a tensor, (E - G, F) (2.82): both are linear, so that interpolation
//! commutes, and stream lines load half as much. Read as a tensor whose G is 0 it has the same
//! eigenvectors.
//!
//! Cost: a subtraction per pixel.

use crate::kernels::simd::pixels::{for_blocks, write};
use isophote_engine::fearless_simd::dispatch;
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(orientation_field {
    cpu: run,
    cost: |_| 1.0,
    tolerance: Tolerance::of_rounding(1e-7, 1e-6, "two roundings"),
});

/// (E - G, F) of a tensor image.
pub fn pass(plan: &mut PlanBuilder, tensor: ImageId) -> ImageId {
    plan.pass(&KERNEL, &[tensor], &(), Class::Field, Support::Pixels(0))
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let view = &pass.inputs[0];
    dispatch!(pass.level, simd => for_blocks::<2>(band, #[inline(always)] |block, target| {
        let [e, f, g, _] = block.read(simd, view);
        write([e - g, f], target);
    }));
}
