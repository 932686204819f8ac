//! Takes the colour of a neighbouring frame, carried here along motion, into an average. The interpolation is sharp (the
//! cubic of Catmull and Rom), since a picture that is carried again and again by a bilinear one would blur.
//!
//! Cost: 16 taps of four channels and about 100 operations; hardly anything where the frame counts for nothing.

use crate::kernels::shared::coverage::{LEAST_COVERAGE, unpremultiply};
use crate::kernels::shared::motion::sample_sharp_covered4;
use crate::kernels::simd::carrying::{self, Carried, take_in};
use isophote_engine::fearless_simd::prelude::*;
use isophote_engine::fearless_simd::{Simd, f32x8};
use isophote_engine::{Class, ImageId, PlanBuilder, Tolerance, View};

crate::kernel!(carry_colour {
    cpu: |simd, pass, band| take_in(
        simd,
        pass,
        band,
        #[inline(always)]
        |carried| mixed(simd, &pass.inputs[3], carried),
    ),
    cost: |_| 180.0,
    tolerance: Tolerance {
        absolute: 1e-3,
        relative: 2e-4,
        outliers: 2e-3,
        reason: "the rounding of a position times the contrast between neighbours",
    },
});

/// The colour of the first of `images` with that of the second taken in, where the motion in `by` leads to and as far as
/// the shares in it say; motions are at most `reach` pixels long.
pub fn pass(plan: &mut PlanBuilder, images: [ImageId; 2], by: [ImageId; 2], reach: u32) -> ImageId {
    carrying::pass(plan, &KERNEL, images, by, Class::Colour, [0, reach + 2])
}

#[inline(always)]
fn mixed<S: Simd>(simd: S, theirs: &View<'_>, carried: &Carried<S, 4>) -> [f32x8<S>; 4] {
    let Carried { own, share, place: [x, y], .. } = *carried;
    let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
    let mut carried = sample_sharp_covered4(simd, theirs, x, y);
    carried[3] = carried[3].within(zero, one);
    let carried = unpremultiply(carried);
    let alpha = (carried[3] - own[3]).mul_add(share, own[3]);
    let weight = alpha.simd_gt(LEAST_COVERAGE).select(share * carried[3] / alpha, zero);
    let mut mixed = own;
    for c in 0..3 {
        mixed[c] = (carried[c] - own[c]).mul_add(weight, own[c]);
    }
    mixed[3] = alpha;
    mixed
}
