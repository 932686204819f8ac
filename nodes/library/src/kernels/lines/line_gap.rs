//! Share of lines that stays where things stand in front of others: those of what is behind end a little before the outline
//! of what is in front, as illustrators draw them (haloed lines: Appel, Rohlf and Stein 1979).
//!
//! Cost: a division per pixel.

use crate::kernels::shared::breaks::nearness;
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Class, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(line_gap {
    block: |simd, pass| |block| {
        let [z] = block.read(simd, &pass.inputs[0]);
        kept(z, block.read(simd, &pass.inputs[1]), block.read(simd, &pass.inputs[2]))
    },
    cost: |_| 16.0,
    tolerance: Tolerance {
        absolute: 0.0,
        relative: 0.0,
        outliers: 1e-3,
        reason: "what is just as much nearer as counts is in front or is not",
    },
});

/// Nearness of what is not in front of a pixel, against its own.
const SAME: f32 = 1.04;

/// (0, 0, 0, share) of the depth and of the [`occluders`](super::occluders) within the width of their outline, and within that
/// and the gap; images in this order.
pub fn pass(plan: &mut PlanBuilder, images: [ImageId; 3]) -> ImageId {
    plan.pass(&KERNEL, &images, &(), Class::Field, Support::Pixels(0))
}

#[inline(always)]
fn kept<S: Simd>(z: f32x8<S>, [beside, ..]: [f32x8<S>; 4], [around, ..]: [f32x8<S>; 4]) -> [f32x8<S>; 4] {
    let (zero, one) = (f32x8::splat(z.simd, 0.0), f32x8::splat(z.simd, 1.0));
    let is_there = z.abs().simd_le(f32::MAX) & z.simd_gt(0.0);
    let own = nearness(is_there.select(z, zero)) * SAME;
    // The outline of the nearest thing, not that of another one behind it.
    let is_first = beside.simd_gt(own) & (beside * SAME).simd_ge(around);
    let behind = around.simd_gt(own).select(one, zero);
    [zero, zero, zero, one - is_first.select(zero, behind)]
}
