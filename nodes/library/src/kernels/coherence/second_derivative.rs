//! The second derivative of each colour channel along the major eigenvector, by central differences: the
//! detector of the coherence-enhancing shock filter (§ 6.4.2), negative in the zone of a maximum. Where a
//! neighbour is transparent it stands for the centre.
//!
//! Cost: 25 operations a channel.

use crate::kernels::shared::tensor::axis;
use crate::kernels::simd::neighbours::{Neighbours, each};
use isophote_engine::fearless_simd::{dispatch, f32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(second_derivative {
    cpu: run,
    cost: |_| 90.0,
    tolerance: Tolerance {
        absolute: 1e-6,
        relative: 4e-6,
        outliers: 5e-3,
        reason: "differences magnify the last bits of colours that are larger than the result",
    },
});

/// The second derivative of a colour along the major eigenvectors of `tensors`, in its unit per square
/// pixel.
pub fn pass(plan: &mut PlanBuilder, color: ImageId, tensors: ImageId) -> ImageId {
    plan.pass(&KERNEL, &[color, tensors], &(), Class::Field, Support::Pixels(1))
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    dispatch!(pass.level, simd => each(simd, &pass.inputs[0], band, #[inline(always)] |around: Neighbours<'_, _>| {
        let [e, f, g, _] = around.block.read(simd, &pass.inputs[1]);
        let (_, [x, y]) = axis((e - g) * 0.5, f);
        let mut result = [f32x8::splat(simd, 0.0); 4];
        for (c, result) in result.iter_mut().take(3).enumerate() {
            let xx = around.excess(-1, 0, c) + around.excess(1, 0, c);
            let yy = around.excess(0, -1, c) + around.excess(0, 1, c);
            let rising = around.excess(1, 1, c) + around.excess(-1, -1, c);
            let falling = around.excess(1, -1, c) + around.excess(-1, 1, c);
            let xy = (rising - falling) * 0.25;
            *result = x * x * xx + x * y * xy * 2.0 + y * y * yy;
        }
        result
    }));
}
