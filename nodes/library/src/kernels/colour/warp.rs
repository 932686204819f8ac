//! Moves every pixel's sample against the gradient of a field: away from ridges, which narrows whatever
//! blurred edge lies on one (§ 4.6).
//!
//! Cost: one bilinear sample and about 20 operations.

pub use crate::kernels::shaders::warp::Params;
use crate::kernels::shared::coverage::{Covered, unpremultiply};
use crate::kernels::shared::sampling::sample_linear4;
use crate::kernels::simd::neighbours::{Neighbours, each};
use isophote_engine::fearless_simd::prelude::*;
use isophote_engine::fearless_simd::{Simd, dispatch, f32x8};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance, View};

crate::kernel!(warp {
    cpu: run,
    cost: |_| 60.0,
    tolerance: Tolerance {
        absolute: 1e-4,
        relative: 1e-3,
        outliers: 2e-3,
        reason: "the rounding of a position times the contrast between neighbours",
    },
});

/// Samples `color` `amount` pixels per unit of the gradient of `field`'s first channel against it, at
/// most `limit` pixels away.
pub fn pass(plan: &mut PlanBuilder, color: ImageId, field: ImageId, params: &Params) -> ImageId {
    plan.pass(&KERNEL, &[color, field], params, Class::Colour, Support::Pixels(reach(params) as u32))
}

/// A sample this far away reads one pixel further.
fn reach(params: &Params) -> i32 {
    params.limit.ceil() as i32 + 1
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    let covered = Covered::new(&pass.inputs[0], band, reach(&params));
    let source = covered.view(&pass.inputs[0]);
    dispatch!(pass.level, simd => each(simd, &pass.inputs[1], band, #[inline(always)] |around: Neighbours<'_, _>| {
        moved(simd, &params, &source, &around)
    }));
}

#[inline(always)]
fn moved<S: Simd>(simd: S, params: &Params, source: &View<'_>, around: &Neighbours<'_, S>) -> [f32x8<S>; 4] {
    // The field's last channel is 1: excess is the plain difference.
    let factor = -0.5 * params.amount;
    let x = (around.excess(1, 0, 0) - around.excess(-1, 0, 0)) * factor;
    let y = (around.excess(0, 1, 0) - around.excess(0, -1, 0)) * factor;
    let length = (x * x + y * y).sqrt();
    let share =
        f32x8::splat(simd, params.limit) / length.at_least(f32x8::splat(simd, params.limit.max(1e-6)));
    let [cx, cy] = around.block.centres(simd);
    unpremultiply(sample_linear4(simd, source, x * share + cx, y * share + cy))
}
