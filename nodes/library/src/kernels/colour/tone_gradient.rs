//! Gradient of the L of a Lab image by the Sobel operator (2.23), in the first two of four channels, so that the kernels of
//! fields can smooth it. Long ones count the less the longer they are, since an edge is no change of tone: a mean of gradients
//! then says how much the tones around change, and beside an edge flat ones stay flat. Where a neighbour is transparent it
//! stands for the centre.
//!
//! Cost: 40 operations.

pub use crate::kernels::shaders::tone_gradient::Params;
use crate::kernels::simd::neighbours::{Neighbours, each};
use isophote_engine::fearless_simd::{dispatch, f32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(tone_gradient {
    cpu: run,
    cost: |_| 40.0,
    tolerance: Tolerance {
        absolute: 1e-3,
        relative: 1e-4,
        outliers: 0.002,
        reason: "differences magnify the last bits of lightness, and those of broken pictures are a thousand times as large",
    },
});

/// The gradient, units of L per pixel; one that is n times as long as `longest` has an nth of that length.
pub fn pass(plan: &mut PlanBuilder, lab: ImageId, longest: f32) -> ImageId {
    plan.pass(&KERNEL, &[lab], &Params { longest }, Class::Colour, Support::Pixels(1))
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    dispatch!(pass.level, simd => each(simd, &pass.inputs[0], band, #[inline(always)] |around: Neighbours<'_, _>| {
        let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
        let (left_up, left_down) = (around.excess(-1, -1, 0), around.excess(-1, 1, 0));
        let (right_up, right_down) = (around.excess(1, -1, 0), around.excess(1, 1, 0));
        let x = (around.excess(1, 0, 0) - around.excess(-1, 0, 0)) * 0.25
            + ((right_up - left_up) + (right_down - left_down)) * 0.125;
        let y = (around.excess(0, 1, 0) - around.excess(0, -1, 0)) * 0.25
            + ((left_down - left_up) + (right_down - right_up)) * 0.125;
        let length = (x * x + y * y).sqrt().max(1e-6);
        let share = (one * params.longest / length).min(one);
        let shorter = share * share * around.centre(3);
        [x * shorter, y * shorter, zero, one]
    }));
}
