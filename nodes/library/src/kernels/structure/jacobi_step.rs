//! One Jacobi step of Laplace's equation (2.166) on tensors: those that are not valid become the mean
//! of their four neighbours, valid ones stay (2.171, Listing 2.3). Beyond the border the field goes
//! on unchanged.
//!
//! Cost: 4 additions on four channels where a tensor is not valid.

use super::{tensor_interpolate, tensor_restrict};
use isophote_engine::fearless_simd::{Simd, f32x4, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(jacobi_step {
    cpu: |simd, pass, band| average(simd, pass, band),
    cost: |_| 16.0,
    tolerance: Tolerance::of_rounding(1e-6, 2e-6, "three additions in the same order"),
});

/// Adds the pass.
pub fn pass(plan: &mut PlanBuilder, tensor: ImageId) -> ImageId {
    plan.pass(&KERNEL, &[tensor], &(), Class::Field, Support::Pixels(1))
}

/// Replaces tensors that are not valid (w = 0) by a membrane spanned over the valid ones (2.165): a
/// pyramid of means up to one pixel, and down again with `steps` Jacobi steps on each level (§ 2.7.3).
/// If no tensor is valid, the field is 0.
pub fn relax(plan: &mut PlanBuilder, tensor: ImageId, steps: i32) -> ImageId {
    if plan.level_size(plan.desc(tensor).level) == [1, 1] {
        return tensor;
    }
    let coarse = tensor_restrict::pass(plan, tensor);
    let coarse = relax(plan, coarse, steps);
    let mut filled = tensor_interpolate::pass(plan, tensor, coarse);
    for _ in 0..steps {
        filled = pass(plan, filled);
    }
    filled
}

#[inline(always)]
fn average<S: Simd>(simd: S, pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let window = band.window;
    let view = &pass.inputs[0];
    let mut scratch = Vec::new();
    let len = 4 * window.width() as usize;
    for y in window.y0..window.y1 {
        let row = |y: i32| {
            let at = view.offset(window.x0, y);
            &view.data()[at..at + len]
        };
        let (above, below) = (row(y - 1), row(y + 1));
        let centre = view.padded_row(y, window.x0 - 1, window.x1 + 1, &mut scratch);
        for (x, target) in band.row_mut(0, y).chunks_exact_mut(4).enumerate() {
            if centre[4 * x + 7] >= 1.0 {
                load(simd, centre, x + 1).store_slice(target);
                continue;
            }
            let across = load(simd, centre, x + 2) + load(simd, centre, x);
            let along = load(simd, below, x) + load(simd, above, x);
            ((across + along) * 0.25).store_slice(target);
            target[3] = 0.0;
        }
    }
}

#[inline(always)]
fn load<S: Simd>(simd: S, row: &[f32], x: usize) -> f32x4<S> {
    f32x4::from_slice(simd, &row[4 * x..4 * x + 4])
}
