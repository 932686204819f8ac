//! Takes the structure tensor of a neighbouring frame, carried here along motion and turned with it, into an average.
//!
//! A picture I of that frame shows here as I(x + m(x)). Its gradient is J^T times the gradient there, J = 1 + Dm being
//! the Jacobian of the motion, and its tensor J^T T J. The interpolation is bilinear: smoothed tensors are smooth, and
//! the mean of tensors is one, which a sharper interpolation with its negative weights does not promise.
//!
//! Cost: a bilinear sample of four channels and about 80 operations.

use crate::kernels::shared::motion::{beside, sample_linear_near4};
use crate::kernels::simd::pixels::{Block, for_blocks, write};
use isophote_engine::fearless_simd::{Simd, dispatch, f32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(carry_tensor {
    cpu: run,
    cost: |_| 110.0,
    tolerance: Tolerance {
        absolute: 1e-6,
        relative: 2e-3,
        outliers: 2e-3,
        reason: "the rounding of a position times the differences of neighbours, and derivatives at their bound",
    },
});

/// Larger differences of motion between neighbours are borders of things.
const BORDER: f32 = 0.5;

/// The tensor `average` with that of `theirs` taken in, where `motion` leads to and as far as `shares` says
/// ([`carried_share`](super::carried_share)); motions are at most `reach` pixels long.
pub fn pass(
    plan: &mut PlanBuilder,
    [average, theirs]: [ImageId; 2],
    [motion, shares]: [ImageId; 2],
    reach: u32,
) -> ImageId {
    let here = Support::Pixels(0);
    let supports = [here, Support::Pixels(1), here, Support::Pixels(reach + 1)];
    plan.pass_reaching(&KERNEL, &[average, motion, shares, theirs], &(), &[Class::Field], &supports, 0)
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    dispatch!(pass.level, simd => for_blocks::<4>(band, #[inline(always)] |block, target| {
        write(taken_in(simd, pass, block), target);
    }));
}

#[inline(always)]
fn taken_in<S: Simd>(simd: S, pass: &CpuPass<'_>, block: Block) -> [f32x8<S>; 4] {
    let zero = f32x8::splat(simd, 0.0);
    let own: [f32x8<S>; 4] = block.read(simd, &pass.inputs[0]);
    let [share, _]: [f32x8<S>; 2] = block.read(simd, &pass.inputs[2]);
    let counts = share.simd_gt(zero);
    if !counts.any_true() {
        return own;
    }
    let motion = &pass.inputs[1];
    let at: [f32x8<S>; 2] = block.read(simd, motion);
    let (left, right) = (beside(simd, motion, block, [-1, 0]), beside(simd, motion, block, [1, 0]));
    let (above, below) = (beside(simd, motion, block, [0, -1]), beside(simd, motion, block, [0, 1]));
    let dx = [derivative(left[0], at[0], right[0]), derivative(left[1], at[1], right[1])];
    let dy = [derivative(above[0], at[0], below[0]), derivative(above[1], at[1], below[1])];
    let (a, b, c, d) = (dx[0] + 1.0, dy[0], dx[1], dy[1] + 1.0);
    let [cx, cy] = block.centres(simd);
    let (x, y) = (cx + counts.select(at[0], zero), cy + counts.select(at[1], zero));
    let [e, f, g, w] = sample_linear_near4(simd, &pass.inputs[3], x, y);
    let turned = [
        a * a * e + a * c * f * 2.0 + c * c * g,
        a * b * e + (a * d + b * c) * f + c * d * g,
        b * b * e + b * d * f * 2.0 + d * d * g,
        w,
    ];
    let mut result = own;
    for i in 0..4 {
        result[i] = counts.select((turned[i] - own[i]).mul_add(share, own[i]), own[i]);
    }
    result
}

/// The smaller one-sided difference, and none across borders of things.
#[inline(always)]
fn derivative<S: Simd>(before: f32x8<S>, at: f32x8<S>, after: f32x8<S>) -> f32x8<S> {
    let (low, high) = (at - before, after - at);
    let smaller = low.abs().simd_lt(high.abs()).select(low, high);
    smaller.abs().simd_lt(BORDER).select(smaller, f32x8::splat(at.simd, 0.0))
}
