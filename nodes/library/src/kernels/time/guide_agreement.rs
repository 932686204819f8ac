//! Agreement of a guide of a neighbouring frame with that of the frame at hand, 0..=1: depths up to a difference of a
//! twentieth, none from a tenth on; object numbers where they are the same. What disagrees was hidden there.
//!
//! Cost: four taps of one channel and about 30 operations.

pub use crate::kernels::shaders::guide_agreement::Params;
use crate::kernels::shared::motion::is_known;
use crate::kernels::simd::pixels::{Block, fetch1, offsets};
use isophote_engine::fearless_simd::{Simd, f32x8, i32x8, prelude::*};
use isophote_engine::{Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(guide_agreement {
    block: |simd, pass, params| |block| [agreement(simd, pass, &params, block)],
    cost: |_| 50.0,
    tolerance: Tolerance {
        absolute: 1e-3,
        relative: 0.0,
        outliers: 2e-3,
        reason: "a position that is rounded to another pixel",
    },
});

/// Content of a guide.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Guide {
    /// Distances from the camera.
    Depth = 0,
    /// Object numbers.
    ObjectId = 1,
}

/// Way from the points of the frame at hand to a neighbouring one.
#[derive(Clone, Copy, Debug)]
pub struct Way {
    /// Two channels.
    pub motion: ImageId,
    /// Longest motion, pixels.
    pub reach: u32,
}

/// The agreement of the guide `own` with `theirs`, times `weights` where there are some.
pub fn pass(
    plan: &mut PlanBuilder,
    [own, theirs]: [ImageId; 2],
    guide: Guide,
    way: Way,
    weights: Option<ImageId>,
) -> ImageId {
    let params = Params { kind: guide as i32, weighted: f32::from(u8::from(weights.is_some())) };
    let inputs = [own, way.motion, weights.unwrap_or(own), theirs];
    let here = Support::Pixels(0);
    let supports = [here, here, here, Support::Pixels(way.reach + 1)];
    plan.pass_reaching(&KERNEL, &inputs, &params, &[Class::Field], &supports, 0)
}

#[inline(always)]
fn agreement<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, block: Block) -> f32x8<S> {
    let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
    let theirs = &pass.inputs[3];
    let [here]: [f32x8<S>; 1] = block.read(simd, &pass.inputs[0]);
    let motion: [f32x8<S>; 2] = block.read(simd, &pass.inputs[1]);
    let known = is_known(motion);
    let [cx, cy] = block.centres(simd);
    let place = |p: f32x8<S>, full: i32| (p - 0.5).within(-2.0f32, full as f32 + 2.0).floor();
    let [w, h] = theirs.full();
    let x: i32x8<S> = place(cx + known.select(motion[0], zero), w).to_int();
    let y: i32x8<S> = place(cy + known.select(motion[1], zero), h).to_int();
    let mut best = zero;
    for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
        let there = fetch1(simd, theirs, offsets(theirs, x + dx, y + dy));
        let alike = if params.kind == Guide::ObjectId as i32 {
            here.simd_eq(there).select(one, zero)
        } else {
            let far = (here - there).abs() / here.at_least(1e-20);
            let nothing = here.simd_le(0.0) & there.simd_le(0.0);
            nothing.select(one, (far * -20.0 + 2.0).within(zero, one))
        };
        best = best.at_least(alike);
    }
    if params.weighted > 0.0 {
        let [weight]: [f32x8<S>; 1] = block.read(simd, &pass.inputs[2]);
        best *= weight;
    }
    best
}
