//! A motion field at twice the resolution, bilinearly; motions are twice as many pixels long there.
//!
//! Cost: 8 multiply-adds.

use crate::kernels::simd::upsampling::Upsampling;
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(motion_interpolate {
    cpu: run,
    cost: |_| 8.0,
    tolerance: Tolerance::of_rounding(
        1e-5,
        1e-6,
        "three interpolations with exact weights in the same order"
    ),
});

/// Adds the pass: from the field's level to the next finer one.
pub fn pass(plan: &mut PlanBuilder, motion: ImageId) -> ImageId {
    let level = plan.desc(motion).level - 1;
    plan.pass_at(&KERNEL, &[motion], &(), &[Class::Field], Support::Pixels(1), level)
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let window = band.window;
    let mut upsampling = Upsampling::default();
    for y in window.y0..window.y1 {
        let row = upsampling.row::<2>(&pass.inputs[0], y, [window.x0, window.x1], false);
        for (target, value) in band.row_mut(0, y).iter_mut().zip(row) {
            *target = 2.0 * value;
        }
    }
}
