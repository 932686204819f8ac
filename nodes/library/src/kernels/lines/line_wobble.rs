//! Moves lines a little along two fields of noise, one for each axis, so that they waver as a hand's do (Bousseau et al.
//! 2006, who move outlines so). What the lines are drawn over stays where it is.
//!
//! Cost: 16 taps of one channel and about 60 operations.

pub use crate::kernels::shaders::line_wobble::Params;
use crate::kernels::shared::motion::sample_sharp1;
use crate::kernels::simd::pixels::Block;
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(line_wobble {
    block: |simd, pass, params| |block| [wavering(simd, pass, &params, block)],
    cost: |_| 110.0,
    tolerance: Tolerance {
        absolute: 2e-5,
        relative: 0.0,
        outliers: 0.0,
        reason: "the rounding of a position times the contrast between neighbours",
    },
});

/// Edges (1 = paper, 0 = line), fetched from where grey noise, 0..=1 about 0.5, leads along x and along y.
pub fn pass(plan: &mut PlanBuilder, edges: ImageId, [x, y]: [ImageId; 2], params: &Params) -> ImageId {
    let (here, around) = (Support::Pixels(0), Support::Pixels(reach(params)));
    let class = plan.desc(edges).class;
    plan.pass_reaching(&KERNEL, &[edges, x, y], params, &[class], &[around, here, here], 0)
}

/// The sharp interpolation reads two pixels further.
fn reach(params: &Params) -> u32 {
    params.amount.ceil() as u32 + 2
}

#[inline(always)]
fn wavering<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, block: Block) -> f32x8<S> {
    let [x, y] = block.centres(simd);
    let [along_x, along_y] = [&pass.inputs[1], &pass.inputs[2]];
    let [right, ..]: [f32x8<S>; 4] = block.read(simd, along_x);
    let [down, ..]: [f32x8<S>; 4] = block.read(simd, along_y);
    let dx = ((right - 0.5) * params.gain).within(-params.amount, params.amount);
    let dy = ((down - 0.5) * params.gain).within(-params.amount, params.amount);
    // A sharp interpolation overshoots.
    sample_sharp1(simd, &pass.inputs[0], x + dx, y + dy).within(0.0, 1.0)
}
