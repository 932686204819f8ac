//! From where a pixel is to where its point was when each of two layers of marks was anchored, frame by frame: what was
//! found so far, and the next step where that leads to. A point whose motion is not known, or that goes too far, stays
//! where it is for a frame: its marks begin there.
//!
//! Points may leave the picture; beyond its border the motion of the border goes on.
//!
//! Cost: two bilinear samples of two channels and about 60 operations.

pub use crate::kernels::shaders::mark_chain::Params;
use crate::kernels::shared::motion::{is_known, motion_at};
use crate::kernels::simd::pixels::Block;
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(mark_chain {
    block: |simd, pass, params| |block| chained(simd, pass, block, &params),
    cost: |_| 110.0,
    tolerance: Tolerance {
        absolute: 1e-4,
        relative: 1e-4,
        outliers: 4e-3,
        reason: "the rounding of a position times the differences of neighbours, and what goes to the other side of a \
                 border or a limit on the last bit",
    },
});

/// A step of the chain.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    /// Longest motion from frame to frame that counts, pixels.
    pub longest: f32,
    /// Farthest on each axis that marks are carried, pixels.
    pub farthest: f32,
    /// Number of steps that came before.
    pub count: u32,
    /// True for layers that were anchored before the frame that this step leads from.
    pub advance: [bool; 2],
}

/// The motions of two layers so far, none before the first step, and then those of `motion`, which may hold anything, in
/// the frame that they lead to: x and y of the first layer, then of the second.
pub fn pass(plan: &mut PlanBuilder, so_far: Option<ImageId>, motion: ImageId, step: &Step) -> ImageId {
    let params = Params {
        step: step.longest,
        limit: step.farthest,
        advance: step.advance.map(u32::from),
        begin: so_far.is_none().into(),
        padding: Default::default(),
    };
    let reach = (step.longest * step.count as f32).min(step.farthest).ceil() as u32 + 1;
    let supports = [Support::Pixels(0), Support::Pixels(reach)];
    let inputs = [so_far.unwrap_or(motion), motion];
    plan.pass_reaching(&KERNEL, &inputs, &params, &[Class::Field], &supports, 0)
}

#[inline(always)]
fn chained<S: Simd>(simd: S, pass: &CpuPass<'_>, block: Block, params: &Params) -> [f32x8<S>; 4] {
    let mut found = [f32x8::splat(simd, 0.0); 4];
    if params.begin == 0 {
        found = block.read(simd, &pass.inputs[0]);
    }
    let [cx, cy] = block.centres(simd);
    for layer in 0..2 {
        if params.advance[layer] == 0 {
            continue;
        }
        let [x, y] = [found[2 * layer], found[2 * layer + 1]];
        let step = motion_at(simd, &pass.inputs[1], cx + x, cy + y, params.step);
        let whole = [x + step[0], y + step[1]];
        let near = whole[0].abs().simd_le(params.limit) & whole[1].abs().simd_le(params.limit);
        let goes = is_known(step) & near;
        found[2 * layer] = goes.select(whole[0], x);
        found[2 * layer + 1] = goes.select(whole[1], y);
    }
    found
}
