//! Colour and opacity of a line at each pixel, by the kinds of lines that geometry draws ([`line_kinds`](
//! crate::kernels::lines::line_kinds)).
//!
//! Cost: a division and about 60 operations per pixel.

pub use crate::kernels::shaders::line_paint::Params;
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Class, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(line_paint {
    block: |simd, pass, params| |block| paint(&params, block.read(simd, &pass.inputs[0])),
    cost: |_| 70.0,
    tolerance: Tolerance::of_rounding(1e-4, 1e-5, "high powers of densities magnify their rounding"),
});

/// Densities, against that of a lone break, from which on a line is not of the picture's own edges, and one over the range
/// over which it comes to be of geometry alone.
const FROM: f32 = 0.12;
const INVERSE_RANGE: f32 = 5.0;

/// Rank of creases, outlines and borders where several are as dense.
const RANKS: [f32; 3] = [1.0, 1.6, 1.3];

/// Least sum of weights that is divided by.
const LEAST: f32 = 1e-20;

/// RGB and opacity of lines, by smoothed densities of kinds.
pub fn pass(plan: &mut PlanBuilder, kinds: ImageId, params: &Params) -> ImageId {
    plan.pass(&KERNEL, &[kinds], params, Class::Colour, Support::Pixels(0))
}

#[inline(always)]
fn paint<S: Simd>(params: &Params, [crease, outline, border, _]: [f32x8<S>; 4]) -> [f32x8<S>; 4] {
    let one = f32x8::splat(crease.simd, 1.0);
    let mut weights = [crease, outline, border];
    let mut densest = one * 0.0;
    for (weight, rank) in weights.iter_mut().zip(RANKS) {
        let density = (*weight * params.inverse_peak).within(0.0, 1.0);
        densest = densest.at_least(density);
        // The densest kind decides, and outlines before borders before creases.
        let ranked = density * rank;
        let squared = ranked * ranked;
        *weight = squared * squared * squared;
    }
    let sum = (weights[0] + weights[1] + weights[2]).at_least(LEAST);
    let t = ((densest - FROM) * INVERSE_RANGE).within(0.0, 1.0);
    let share = t * t * (t * -2.0 + 3.0);
    let mut result = [one; 4];
    for (channel, value) in result.iter_mut().enumerate() {
        let [crease, outline, border] =
            [params.crease[channel], params.outline[channel], params.border[channel]];
        let own = (weights[0] * crease + weights[1] * outline + weights[2] * border) / sum;
        let line = one * params.line[channel];
        *value = line + share * (own - line);
    }
    result
}
