//! Weight of a neighbouring frame beside those before it, where its colour agrees: its share of the average so
//! far, and the sum of all weights, that of the frame at hand being 1.
//!
//! If the motion is unknown or leads out of the picture, it counts for nothing.
//!
//! Cost: a bilinear sample of four channels, an exponential and about 40 operations.

pub use crate::kernels::shaders::carried_share::Params;
use crate::kernels::shared::coverage::unpremultiply;
use crate::kernels::shared::motion::{is_inside, is_known, sample_linear_covered4};
use crate::kernels::simd::pixels::Block;
use isophote_engine::fearless_simd::prelude::*;
use isophote_engine::fearless_simd::{Simd, f32x8};
use isophote_engine::math::Elementary;
use isophote_engine::{Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(carried_share {
    block: |simd, pass, params| |block| shares(simd, pass, &params, block),
    cost: |_| 100.0,
    tolerance: Tolerance {
        absolute: 2e-4,
        relative: 1e-3,
        outliers: 2e-3,
        reason: "the rounding of a position times the contrast between neighbours, in an exponent",
    },
});

/// A neighbouring frame on its way to the one at hand.
#[derive(Clone, Copy, Debug)]
pub struct Neighbour {
    /// Motion to the points of the frame at hand in it.
    pub motion: ImageId,
    /// Longest of these motions, pixels.
    pub reach: u32,
    /// Weight of the frame by its distance in time, 0..=1.
    pub gain: f32,
    /// Standard deviation of the Gaussian over differences of colour, in units of the colour.
    pub sigma: f32,
    /// Units of colour that a difference of alpha of 1 counts as.
    pub alpha: f32,
    /// Degree to which the guides agree, where there are some.
    pub weights: Option<ImageId>,
}

/// The share of `theirs` and the sum of weights, two channels; `before` is the result for
/// the frame that was taken in before.
pub fn pass(
    plan: &mut PlanBuilder,
    [own, theirs]: [ImageId; 2],
    before: Option<ImageId>,
    neighbour: &Neighbour,
) -> ImageId {
    let Neighbour { motion, reach, gain, sigma, alpha, weights } = *neighbour;
    let params = Params {
        gain,
        falloff: std::f32::consts::LOG2_E / (2.0 * sigma * sigma).max(1e-6),
        alpha,
        weighted: f32::from(u8::from(weights.is_some())),
        follows: f32::from(u8::from(before.is_some())),
    };
    let inputs = [own, motion, weights.unwrap_or(motion), before.unwrap_or(motion), theirs];
    let here = Support::Pixels(0);
    let supports = [here, here, here, here, Support::Pixels(reach + 1)];
    plan.pass_reaching(&KERNEL, &inputs, &params, &[Class::Field], &supports, 0)
}

#[inline(always)]
fn shares<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, block: Block) -> [f32x8<S>; 2] {
    let theirs = &pass.inputs[4];
    let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
    let here: [f32x8<S>; 4] = block.read(simd, &pass.inputs[0]);
    let motion: [f32x8<S>; 2] = block.read(simd, &pass.inputs[1]);
    let known = is_known(motion);
    let [cx, cy] = block.centres(simd);
    let (x, y) = (cx + known.select(motion[0], zero), cy + known.select(motion[1], zero));
    let there = unpremultiply(sample_linear_covered4(simd, theirs, x, y));
    let mut distance = zero;
    for c in 0..4 {
        let difference = (here[c] - there[c]) * if c == 3 { params.alpha } else { 1.0 };
        distance = difference.mul_add(difference, distance);
    }
    let agreement = (distance * -params.falloff).exp2_falling();
    let guided = if params.weighted > 0.0 {
        let [weight]: [f32x8<S>; 1] = block.read(simd, &pass.inputs[2]);
        weight
    } else {
        one
    };
    let total = if params.follows > 0.0 {
        let [_, total]: [f32x8<S>; 2] = block.read(simd, &pass.inputs[3]);
        total
    } else {
        one
    };
    let weight = known.select(agreement * guided * params.gain, zero);
    let weight = is_inside(x, y, theirs.full()).select(weight, zero);
    let sum = total + weight;
    [weight / sum, sum]
}
