//! Blend of two pictures, by coverage and by a mask: the port `mask` of every colour node.
//!
//! A mask of 0 lets the first picture pass to the bit, and one of 1, where the amount is 1 too, the second.
//!
//! Cost: ten multiply-adds and a division per pixel.

pub use crate::kernels::shaders::mix_by_mask::Params;
use crate::kernels::shared::coverage::unpremultiply;
use crate::kernels::shared::host_colour::finite_pixels;
use crate::kernels::simd::pixels::{for_blocks, write};
use isophote_engine::fearless_simd::prelude::*;
use isophote_engine::fearless_simd::{dispatch, f32x8};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(mix_by_mask {
    cpu: run,
    cost: |_| 16.0,
    tolerance: Tolerance::of_rounding(1e-6, 2e-6, "a dozen roundings"),
});

/// (1 - amount mask) first + amount mask second; `mask` has one channel, cut to 0..=1.
pub fn pass(plan: &mut PlanBuilder, [first, second]: [ImageId; 2], mask: ImageId, amount: f32) -> ImageId {
    plan.pass(&KERNEL, &[first, second, mask], &Params { amount }, Class::Colour, Support::Pixels(0))
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let amount = pass.params::<Params>().amount;
    dispatch!(pass.level, simd => for_blocks::<4>(band, #[inline(always)] |block, target| {
        let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
        let a: [f32x8<_>; 4] = block.read(simd, &pass.inputs[0]);
        let b: [f32x8<_>; 4] = block.read(simd, &pass.inputs[1]);
        let [mask]: [f32x8<_>; 1] = block.read(simd, &pass.inputs[2]);
        // As coverage comes in: cut to 0..=1, and 0 for what is not a number.
        let share = finite_pixels([zero, zero, zero, mask])[3] * amount;
        let (wa, wb) = (a[3] * (one - share), b[3] * share);
        let mut mixed = [wa + wb; 4];
        for c in 0..3 {
            mixed[c] = wa * a[c] + wb * b[c];
        }
        let mut result = unpremultiply(mixed);
        for c in 0..4 {
            result[c] = share.simd_eq(one).select(b[c], share.simd_eq(zero).select(a[c], result[c]));
        }
        write(result, target);
    }));
}
