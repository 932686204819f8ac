//! Takes the structure tensor of a neighbouring frame, carried here along motion and turned with it, into an average.
//!
//! A picture I of that frame shows here as I(x + m(x)). Its gradient is J^T times the gradient there, J = 1 + Dm being
//! the Jacobian of the motion, and its tensor J^T T J. The interpolation is bilinear: smoothed tensors are smooth, and
//! the mean of tensors is one, which a sharper interpolation with its negative weights does not promise.
//!
//! Cost: a bilinear sample of four channels and about 80 operations.

use crate::kernels::shared::motion::{beside, sample_linear_near4};
use crate::kernels::simd::carrying::{self, Carried, take_in};
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Class, ImageId, PlanBuilder, Tolerance, View};

crate::kernel!(carry_tensor {
    cpu: |simd, pass, band| take_in(
        simd,
        pass,
        band,
        #[inline(always)]
        |carried| mixed(simd, [&pass.inputs[1], &pass.inputs[3]], carried),
    ),
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

/// The tensor of the first of `images` with that of the second taken in, where the motion in `by` leads to and as far as
/// the shares in it say; motions are at most `reach` pixels long.
pub fn pass(plan: &mut PlanBuilder, images: [ImageId; 2], by: [ImageId; 2], reach: u32) -> ImageId {
    carrying::pass(plan, &KERNEL, images, by, Class::Field, [1, reach + 1])
}

#[inline(always)]
fn mixed<S: Simd>(simd: S, [motion, theirs]: [&View<'_>; 2], carried: &Carried<S, 4>) -> [f32x8<S>; 4] {
    let Carried { block, own, share, motion: at, place: [x, y] } = *carried;
    let (left, right) = (beside(simd, motion, block, [-1, 0]), beside(simd, motion, block, [1, 0]));
    let (above, below) = (beside(simd, motion, block, [0, -1]), beside(simd, motion, block, [0, 1]));
    let dx = [derivative(left[0], at[0], right[0]), derivative(left[1], at[1], right[1])];
    let dy = [derivative(above[0], at[0], below[0]), derivative(above[1], at[1], below[1])];
    let (a, b, c, d) = (dx[0] + 1.0, dy[0], dx[1], dy[1] + 1.0);
    let [e, f, g, w] = sample_linear_near4(simd, theirs, x, y);
    let turned = [
        a * a * e + a * c * f * 2.0 + c * c * g,
        a * b * e + (a * d + b * c) * f + c * d * g,
        b * b * e + b * d * f * 2.0 + d * d * g,
        w,
    ];
    let mut mixed = own;
    for i in 0..4 {
        mixed[i] = (turned[i] - own[i]).mul_add(share, own[i]);
    }
    mixed
}

/// The smaller one-sided difference, and none across borders of things.
#[inline(always)]
fn derivative<S: Simd>(before: f32x8<S>, at: f32x8<S>, after: f32x8<S>) -> f32x8<S> {
    let (low, high) = (at - before, after - at);
    let smaller = low.abs().simd_lt(high.abs()).select(low, high);
    smaller.abs().simd_lt(BORDER).select(smaller, f32x8::splat(at.simd, 0.0))
}
