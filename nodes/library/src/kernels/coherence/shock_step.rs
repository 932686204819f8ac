//! One explicit step of a shock filter (6.3) by the upwind scheme of Osher and Sethian: each channel is
//! dilated where its detector is negative and eroded where it is positive. No step leaves the range of
//! the neighbours as long as the time step is at most 1/2.
//!
//! The sign is soft about 0, so that the rounding of a ramp decides nothing.
//!
//! Cost: 20 operations a channel.

pub use crate::kernels::shaders::shock_step::Params;
use crate::kernels::simd::neighbours::{Neighbours, each};
use isophote_engine::fearless_simd::{dispatch, f32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(shock_step {
    cpu: run,
    cost: |_| 70.0,
    tolerance: Tolerance {
        absolute: 1e-5,
        relative: 1e-5,
        outliers: 2e-3,
        reason: "the soft sign magnifies the last bits of a detector that is nearly 0",
    },
});

/// Steepness of the soft sign: a second derivative of 1e-4 is a sign in full.
const STEEPNESS: f32 = 1e4;

/// Moves `color` by `time_step`, by the sign of `detector`, channel by channel.
pub fn pass(plan: &mut PlanBuilder, color: ImageId, detector: ImageId, time_step: f32) -> ImageId {
    let params = Params { time_step, steepness: STEEPNESS };
    plan.pass(&KERNEL, &[color, detector], &params, Class::Colour, Support::Pixels(1))
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    dispatch!(pass.level, simd => each(simd, &pass.inputs[0], band, #[inline(always)] |around: Neighbours<'_, _>| {
        let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
        let detector: [f32x8<_>; 4] = around.block.read(simd, &pass.inputs[1]);
        let mut result = [zero, zero, zero, around.centre(3)];
        for c in 0..3 {
            let speed = (detector[c] * -params.steepness).within(-one, one);
            let up = speed.simd_gt(zero);
            let mut squares = zero;
            for (dx, dy) in [(-1, 0), (1, 0), (0, -1), (0, 1)] {
                let excess = around.excess(dx, dy, c);
                let pull = up.select(excess, -excess).at_least(zero);
                squares = pull.mul_add(pull, squares);
            }
            result[c] = (speed * squares.sqrt()).mul_add(f32x8::splat(simd, params.time_step), around.centre(c));
        }
        result
    }));
}
