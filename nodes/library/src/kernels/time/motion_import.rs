//! Motion as it enters: what is too long or no number is unknown.
//!
//! Cost: four comparisons.

pub use crate::kernels::shaders::motion_import::Params;
use crate::kernels::shared::motion::bounded;
use crate::kernels::simd::pixels::map_pixels;
use isophote_engine::fearless_simd::{dispatch, f32x8};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(motion_import {
    cpu: run,
    cost: |_| 4.0,
    tolerance: Tolerance::of_rounding(0.0, 0.0, "values pass or do not"),
});

/// Adds the pass; components longer than `limit` pixels make a motion unknown.
pub fn pass(plan: &mut PlanBuilder, motion: ImageId, limit: f32) -> ImageId {
    plan.pass(&KERNEL, &[motion], &Params { limit }, Class::Field, Support::Pixels(0))
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let limit = pass.params::<Params>().limit;
    dispatch!(pass.level, simd => map_pixels(simd, pass, band, #[inline(always)] |motion: [f32x8<_>; 2]| {
        bounded(motion, limit)
    }));
}
