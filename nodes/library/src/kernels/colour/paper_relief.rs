//! Paper that a host gives: its colours on white, and the depth of its grain, by how much darker it is than the paper around
//! it, in standard deviations of that: 0 on peaks, 0.5 on the average, 1 in pits.
//!
//! Cost: two divisions, a root and about 30 multiply-adds per pixel.

use crate::kernels::shared::coverage::LEAST_COVERAGE;
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Class, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(paper_relief {
    block: |simd, pass| |block| {
        let paper = block.read(simd, &pass.inputs[0]);
        relief(paper, block.read(simd, &pass.inputs[1]), block.read(simd, &pass.inputs[2]))
    },
    cost: |_| 60.0,
    tolerance: Tolerance::of_rounding(1e-4, 1e-5, "a difference of moments, divided by its root"),
});

/// Depth per standard deviation of the lightness.
const DEPTH: f32 = 0.24;

/// Variance of lightness, in units of L, that is the noise of a smooth sheet.
const SMOOTH: f32 = 0.25;

/// The relief of `paper`, whose lightness is (L alpha, alpha), beside what [`lightness_moments`] makes of it, smoothed.
///
/// [`lightness_moments`]: crate::kernels::lines::lightness_moments
pub fn pass(plan: &mut PlanBuilder, paper: ImageId, [lightness, around]: [ImageId; 2]) -> ImageId {
    plan.pass(&KERNEL, &[paper, lightness, around], &(), Class::Colour, Support::Pixels(0))
}

#[inline(always)]
fn relief<S: Simd>(
    [r, g, b, a]: [f32x8<S>; 4],
    [v, alpha]: [f32x8<S>; 2],
    [sum, squares, weight, _]: [f32x8<S>; 4],
) -> [f32x8<S>; 4] {
    let one = f32x8::splat(a.simd, 1.0);
    let covered = weight.at_least(LEAST_COVERAGE);
    let mean = sum / covered;
    let variance = (squares / covered - mean * mean).at_least(0.0) + SMOOTH;
    let l = (v / alpha.at_least(LEAST_COVERAGE)).within(0.0, 120.0);
    let deviations = (mean - l) / variance.sqrt() * alpha.within(0.0, 1.0);
    let depth = (deviations * DEPTH + 0.5).within(0.0, 1.0);
    let opaque = a.within(0.0, 1.0);
    let on_white = [
        one + (r.within(0.0, 1.0) - one) * opaque,
        one + (g.within(0.0, 1.0) - one) * opaque,
        one + (b.within(0.0, 1.0) - one) * opaque,
    ];
    [on_white[0], on_white[1], on_white[2], depth]
}
