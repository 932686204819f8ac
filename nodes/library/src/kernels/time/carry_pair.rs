//! Takes a value of a neighbouring frame, carried here along motion, into an average: the value times coverage, and
//! coverage. The interpolation is that of [`carry_colour`](super::carry_colour).
//!
//! Cost: 16 taps of two channels and about 60 operations.

use crate::kernels::shared::motion::sample_sharp2;
use crate::kernels::simd::carrying::{self, Carried, take_in};
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{ImageId, PlanBuilder, Tolerance, View};

crate::kernel!(carry_pair {
    cpu: |simd, pass, band| take_in(
        simd,
        pass,
        band,
        #[inline(always)]
        |carried| mixed(simd, &pass.inputs[3], carried),
    ),
    cost: |_| 120.0,
    tolerance: Tolerance {
        absolute: 1e-3,
        relative: 2e-4,
        outliers: 2e-3,
        reason: "the rounding of a position times the contrast between neighbours",
    },
});

/// The pair of the first of `images` with that of the second taken in, where the motion in `by` leads to and as far as
/// the shares in it say; motions are at most `reach` pixels long.
pub fn pass(plan: &mut PlanBuilder, images: [ImageId; 2], by: [ImageId; 2], reach: u32) -> ImageId {
    let class = plan.desc(images[1]).class;
    carrying::pass(plan, &KERNEL, images, by, class, [0, reach + 2])
}

#[inline(always)]
fn mixed<S: Simd>(simd: S, theirs: &View<'_>, carried: &Carried<S, 2>) -> [f32x8<S>; 2] {
    let Carried { own, share, place: [x, y], .. } = *carried;
    let carried = sample_sharp2(simd, theirs, x, y);
    let mut mixed = own;
    for c in 0..2 {
        mixed[c] = (carried[c] - own[c]).mul_add(share, own[c]);
    }
    mixed
}
