//! Takes a value of a neighbouring frame, carried here along motion, into an average: the value times coverage, and
//! coverage. The interpolation is that of [`carry_colour`](super::carry_colour).
//!
//! Cost: 16 taps of two channels and about 60 operations.

use crate::kernels::shared::motion::sample_sharp2;
use crate::kernels::simd::pixels::{Block, for_blocks, write};
use isophote_engine::fearless_simd::{Simd, dispatch, f32x8, prelude::*};
use isophote_engine::{Band, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(carry_pair {
    cpu: run,
    cost: |_| 120.0,
    tolerance: Tolerance {
        absolute: 1e-3,
        relative: 2e-4,
        outliers: 2e-3,
        reason: "the rounding of a position times the contrast between neighbours",
    },
});

/// The pair `average` with that of `theirs` taken in, where `motion` leads to and as far as `shares` says
/// ([`carried_share`](super::carried_share)); motions are at most `reach` pixels long.
pub fn pass(
    plan: &mut PlanBuilder,
    [average, theirs]: [ImageId; 2],
    [motion, shares]: [ImageId; 2],
    reach: u32,
) -> ImageId {
    let here = Support::Pixels(0);
    let supports = [here, here, here, Support::Pixels(reach + 2)];
    let class = plan.desc(theirs).class;
    plan.pass_reaching(&KERNEL, &[average, motion, shares, theirs], &(), &[class], &supports, 0)
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    dispatch!(pass.level, simd => for_blocks::<2>(band, #[inline(always)] |block, target| {
        write(taken_in(simd, pass, block), target);
    }));
}

#[inline(always)]
fn taken_in<S: Simd>(simd: S, pass: &CpuPass<'_>, block: Block) -> [f32x8<S>; 2] {
    let zero = f32x8::splat(simd, 0.0);
    let own: [f32x8<S>; 2] = block.read(simd, &pass.inputs[0]);
    let [share, _]: [f32x8<S>; 2] = block.read(simd, &pass.inputs[2]);
    let counts = share.simd_gt(zero);
    if !counts.any_true() {
        return own;
    }
    let motion: [f32x8<S>; 2] = block.read(simd, &pass.inputs[1]);
    let [cx, cy] = block.centres(simd);
    let (x, y) = (cx + counts.select(motion[0], zero), cy + counts.select(motion[1], zero));
    let carried = sample_sharp2(simd, &pass.inputs[3], x, y);
    let mut result = own;
    for c in 0..2 {
        result[c] = counts.select((carried[c] - own[c]).mul_add(share, own[c]), own[c]);
    }
    result
}
