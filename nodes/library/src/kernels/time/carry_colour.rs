//! Takes the colour of a neighbouring frame, carried here along motion, into an average. The interpolation is sharp (the
//! cubic of Catmull and Rom), since a picture that is carried again and again by a bilinear one would blur.
//!
//! Cost: 16 taps of four channels and about 100 operations; hardly anything where the frame counts for nothing.

use crate::kernels::shared::coverage::LEAST_COVERAGE;
use crate::kernels::shared::motion::sample_sharp_covered4;
use crate::kernels::simd::pixels::{Block, for_blocks, unpremultiply, write};
use isophote_engine::fearless_simd::{Simd, dispatch, f32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(carry_colour {
    cpu: run,
    cost: |_| 180.0,
    tolerance: Tolerance {
        absolute: 1e-3,
        relative: 2e-4,
        outliers: 2e-3,
        reason: "the rounding of a position times the contrast between neighbours",
    },
});

/// The colour `average` with that of `theirs` taken in, where `motion` leads to and as far as `shares` says
/// ([`carried_share`](super::carried_share)); motions are at most `reach` pixels long.
pub fn pass(
    plan: &mut PlanBuilder,
    [average, theirs]: [ImageId; 2],
    [motion, shares]: [ImageId; 2],
    reach: u32,
) -> ImageId {
    let here = Support::Pixels(0);
    let supports = [here, here, here, Support::Pixels(reach + 2)];
    plan.pass_reaching(&KERNEL, &[average, motion, shares, theirs], &(), &[Class::Colour], &supports, 0)
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    dispatch!(pass.level, simd => for_blocks::<4>(band, #[inline(always)] |block, target| {
        write(taken_in(simd, pass, block), target);
    }));
}

#[inline(always)]
fn taken_in<S: Simd>(simd: S, pass: &CpuPass<'_>, block: Block) -> [f32x8<S>; 4] {
    let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
    let own: [f32x8<S>; 4] = block.read(simd, &pass.inputs[0]);
    let [share, _]: [f32x8<S>; 2] = block.read(simd, &pass.inputs[2]);
    let counts = share.simd_gt(zero);
    if !counts.any_true() {
        return own;
    }
    let motion: [f32x8<S>; 2] = block.read(simd, &pass.inputs[1]);
    let [cx, cy] = block.centres(simd);
    let (x, y) = (cx + counts.select(motion[0], zero), cy + counts.select(motion[1], zero));
    let mut carried = sample_sharp_covered4(simd, &pass.inputs[3], x, y);
    carried[3] = carried[3].within(zero, one);
    let carried = unpremultiply(carried);
    let alpha = (carried[3] - own[3]).mul_add(share, own[3]);
    let weight = alpha.simd_gt(LEAST_COVERAGE).select(share * carried[3] / alpha, zero);
    let mut mixed = own;
    for c in 0..3 {
        mixed[c] = (carried[c] - own[c]).mul_add(weight, own[c]);
    }
    mixed[3] = alpha;
    let mut result = own;
    for c in 0..4 {
        result[c] = counts.select(mixed[c], own[c]);
    }
    result
}
