//! Agreement of where motion to a neighbouring frame and from there back leads with where it started, 0..=1: up to a
//! distance of a pixel, and none from 1.4 pixels on, more for long motions (Sundaram, Brox and Keutzer 2010, with 0.01
//! of the squared length). What does not come back was hidden in one of the frames.
//!
//! Cost: four taps of two channels and about 50 operations.

pub use crate::kernels::shaders::return_agreement::Params;
use crate::kernels::shared::motion::{bounded, corners2, is_known};
use crate::kernels::simd::pixels::Block;
use crate::kernels::time::guide_agreement::Way;
use isophote_engine::fearless_simd::{Simd, f32x8, i32x8, prelude::*};
use isophote_engine::{Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(return_agreement {
    block: |simd, pass, params| |block| [agreement(simd, pass, &params, block)],
    cost: |_| 70.0,
    tolerance: Tolerance {
        absolute: 1e-3,
        relative: 1e-3,
        outliers: 2e-3,
        reason: "a position that is rounded to another pixel",
    },
});

/// The agreement of a way with the motion `back` of the neighbouring frame, which may hold anything, times `weights`
/// where there are some.
pub fn pass(plan: &mut PlanBuilder, way: Way, back: ImageId, weights: Option<ImageId>) -> ImageId {
    let params = Params { limit: way.reach as f32, weighted: f32::from(u8::from(weights.is_some())) };
    let inputs = [way.motion, weights.unwrap_or(way.motion), back];
    let here = Support::Pixels(0);
    let supports = [here, here, Support::Pixels(way.reach + 1)];
    plan.pass_reaching(&KERNEL, &inputs, &params, &[Class::Field], &supports, 0)
}

#[inline(always)]
fn agreement<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, block: Block) -> f32x8<S> {
    let zero = f32x8::splat(simd, 0.0);
    let back = &pass.inputs[2];
    let step: [f32x8<S>; 2] = block.read(simd, &pass.inputs[0]);
    let known = is_known(step);
    let [cx, cy] = block.centres(simd);
    let place = |p: f32x8<S>, full: i32| (p - 0.5).within(-2.0f32, full as f32 + 2.0).floor();
    let [w, h] = back.full();
    let x: i32x8<S> = place(cx + known.select(step[0], zero), w).to_int();
    let y: i32x8<S> = place(cy + known.select(step[1], zero), h).to_int();
    let far = f32x8::splat(simd, 1e18);
    let mut least = far;
    let corners = corners2(simd, back, x, y);
    for i in 0..corners.len() {
        let home = bounded(corners[i], params.limit);
        let (mx, my) = (step[0] + home[0], step[1] + home[1]);
        least = least.at_most(is_known(home).select(mx * mx + my * my, far));
    }
    let slack = (step[0] * step[0] + step[1] * step[1]) * 0.01 + 1.0;
    let mut agreement = (least / slack * -1.0 + 2.0).within(0.0, 1.0);
    if params.weighted > 0.0 {
        let [weight]: [f32x8<S>; 1] = block.read(simd, &pass.inputs[1]);
        agreement *= weight;
    }
    agreement
}
