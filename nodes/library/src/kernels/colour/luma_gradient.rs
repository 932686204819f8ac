//! Magnitude of the gradient of the luma by the Sobel operator (2.23), in the first of four channels, so
//! that the kernels of fields can smooth it. Where a neighbour is transparent it stands for the centre.
//!
//! Cost: 60 operations.

use crate::kernels::simd::neighbours::{Neighbours, each};
use isophote_engine::fearless_simd::{dispatch, f32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(luma_gradient {
    cpu: run,
    cost: |_| 60.0,
    tolerance: Tolerance {
        absolute: 1e-5,
        relative: 4e-6,
        outliers: 0.002,
        reason: "differences magnify the last bits of colours that are larger than the result, and those of \
                 broken pictures are a thousand times as large",
    },
});

/// The magnitude, luma per pixel.
pub fn pass(plan: &mut PlanBuilder, color: ImageId) -> ImageId {
    plan.pass(&KERNEL, &[color], &(), Class::Field, Support::Pixels(1))
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    dispatch!(pass.level, simd => each(simd, &pass.inputs[0], band, #[inline(always)] |around: Neighbours<'_, _>| {
        let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
        let (mut x, mut y) = (zero, zero);
        for (c, share) in [0.2126, 0.7152, 0.0722].into_iter().enumerate() {
            let (left_up, left_down) = (around.excess(-1, -1, c), around.excess(-1, 1, c));
            let (right_up, right_down) = (around.excess(1, -1, c), around.excess(1, 1, c));
            let across = (around.excess(1, 0, c) - around.excess(-1, 0, c)) * 0.5;
            x += (across + ((right_up - left_up) + (right_down - left_down)) * 0.25) * share;
            let along = (around.excess(0, 1, c) - around.excess(0, -1, c)) * 0.5;
            y += (along + ((left_down - left_up) + (right_down - right_up)) * 0.25) * share;
        }
        [(x * x + y * y).sqrt() * around.centre(3) * 0.5, zero, zero, one]
    }));
}
