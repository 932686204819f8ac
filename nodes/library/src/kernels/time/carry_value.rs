//! Takes a value of 0..=1 of a neighbouring frame, an edge image or the density of marks, carried here along motion, into an
//! average. The interpolation is that of [`carry_colour`](super::carry_colour).
//!
//! Cost: 16 taps of one channel and about 60 operations.

use crate::kernels::shared::motion::sample_sharp1;
use crate::kernels::simd::carrying::{self, Carried, take_in};
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{ImageId, PlanBuilder, Tolerance, View};

crate::kernel!(carry_value {
    cpu: |simd, pass, band| take_in(
        simd,
        pass,
        band,
        #[inline(always)]
        |carried| mixed(simd, &pass.inputs[3], carried),
    ),
    cost: |_| 100.0,
    tolerance: Tolerance {
        absolute: 1e-3,
        relative: 2e-4,
        outliers: 2e-3,
        reason: "the rounding of a position times the contrast between neighbours",
    },
});

/// The value of the first of `images` with that of the second taken in, where the motion in `by` leads to and as far
/// as the shares in it say; motions are at most `reach` pixels long.
pub fn pass(plan: &mut PlanBuilder, images: [ImageId; 2], by: [ImageId; 2], reach: u32) -> ImageId {
    let class = plan.desc(images[1]).class;
    carrying::pass(plan, &KERNEL, images, by, class, [0, reach + 2])
}

#[inline(always)]
fn mixed<S: Simd>(simd: S, theirs: &View<'_>, carried: &Carried<S, 1>) -> [f32x8<S>; 1] {
    let Carried { own: [own], share, place: [x, y], .. } = *carried;
    // A sharp interpolation overshoots.
    let theirs = sample_sharp1(simd, theirs, x, y).within(0.0, 1.0);
    [(theirs - own).mul_add(share, own)]
}
