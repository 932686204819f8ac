//! A premultiplied picture and light that is added to it; coverage stays.
//!
//! Cost: three additions per pixel.

use crate::kernels::simd::pixels::{for_blocks, write};
use isophote_engine::fearless_simd::{dispatch, f32x8};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(add_light {
    cpu: run,
    cost: |_| 3.0,
    tolerance: Tolerance::of_rounding(1e-7, 1e-6, "one rounding"),
});

/// Adds the pass.
pub fn pass(plan: &mut PlanBuilder, picture: ImageId, light: ImageId) -> ImageId {
    plan.pass(&KERNEL, &[picture, light], &(), Class::Colour, Support::Pixels(0))
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    dispatch!(pass.level, simd => for_blocks::<4>(band, #[inline(always)] |block, target| {
        let under: [f32x8<_>; 4] = block.read(simd, &pass.inputs[0]);
        let light: [f32x8<_>; 4] = block.read(simd, &pass.inputs[1]);
        write([under[0] + light[0], under[1] + light[1], under[2] + light[2], under[3]], target);
    }));
}
