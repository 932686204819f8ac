//! Blend of two pictures, by coverage: the `mix` parameter of every colour node.
//!
//! Cost: eight multiply-adds and a division per pixel.

pub use crate::kernels::shaders::mix::Params;
use crate::kernels::shared::coverage::unpremultiply;
use crate::kernels::simd::pixels::{for_blocks, write};
use isophote_engine::fearless_simd::{dispatch, f32x8};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(mix {
    cpu: run,
    cost: |_| 12.0,
    tolerance: Tolerance::of_rounding(1e-6, 2e-6, "a dozen roundings"),
});

/// (1 - amount) first + amount second.
pub fn pass(plan: &mut PlanBuilder, first: ImageId, second: ImageId, amount: f32) -> ImageId {
    plan.pass(&KERNEL, &[first, second], &Params { amount }, Class::Colour, Support::Pixels(0))
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let amount = pass.params::<Params>().amount;
    dispatch!(pass.level, simd => for_blocks::<4>(band, #[inline(always)] |block, target| {
        let a: [f32x8<_>; 4] = block.read(simd, &pass.inputs[0]);
        let b: [f32x8<_>; 4] = block.read(simd, &pass.inputs[1]);
        let (wa, wb) = (a[3] * (1.0 - amount), b[3] * amount);
        let mut mixed = [wa + wb; 4];
        for c in 0..3 {
            mixed[c] = wa * a[c] + wb * b[c];
        }
        write(unpremultiply(mixed), target);
    }));
}
