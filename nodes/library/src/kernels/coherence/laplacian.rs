//! The Laplacian of each colour channel, by differences to the four neighbours: the detector of the
//! classical shock filter (§ 6.4.1), negative in the zone of a maximum. Where a neighbour is transparent
//! it stands for the centre.
//!
//! Cost: 8 operations a channel.

use crate::kernels::simd::neighbours::{Neighbours, each};
use isophote_engine::fearless_simd::{dispatch, f32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(laplacian {
    cpu: run,
    cost: |_| 24.0,
    tolerance: Tolerance {
        absolute: 1e-6,
        relative: 2e-6,
        outliers: 2e-3,
        reason: "differences magnify the last bits of colours that are larger than the result",
    },
});

/// The Laplacian of a colour, in its unit per square pixel.
pub fn pass(plan: &mut PlanBuilder, color: ImageId) -> ImageId {
    plan.pass(&KERNEL, &[color], &(), Class::Field, Support::Pixels(1))
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    dispatch!(pass.level, simd => each(simd, &pass.inputs[0], band, #[inline(always)] |around: Neighbours<'_, _>| {
        let mut result = [f32x8::splat(simd, 0.0); 4];
        for (c, result) in result.iter_mut().take(3).enumerate() {
            let across = around.excess(-1, 0, c) + around.excess(1, 0, c);
            let along = around.excess(0, -1, c) + around.excess(0, 1, c);
            *result = across + along;
        }
        result
    }));
}
