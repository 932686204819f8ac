//! Merges the smoothed structure tensors of a level of the multi-scale Kuwahara filter with those of the
//! coarser one, interpolated, each weighted by its anisotropy (§ 5.5.2).
//!
//! Cost: 4 interpolations on four channels, two anisotropies and 20 operations.

use crate::kernels::shared::tensor::anisotropy;
use crate::kernels::simd::pixels::{for_blocks, read, write};
use crate::kernels::simd::upsampling::Upsampling;
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

/// Least anisotropy that counts.
const FLOOR: f32 = 1e-3;

crate::kernel!(propagate_tensor {
    cpu: |simd, pass, band| merge(simd, pass, band),
    cost: |_| 90.0,
    tolerance: Tolerance::of_rounding(
        1e-6,
        1e-4,
        "interpolations in the same order, and a quotient of anisotropies of at least 1e-3"
    ),
});

/// Adds the pass; `coarse` lies one level above `fine`.
pub fn pass(plan: &mut PlanBuilder, fine: ImageId, coarse: ImageId) -> ImageId {
    // Without a floor two isotropic tensors would have no weight, and rounding would decide.
    plan.pass(&KERNEL, &[fine, coarse], &(), Class::Field, Support::Pixels(1))
}

#[inline(always)]
fn merge<S: Simd>(simd: S, pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let mut upsampling = Upsampling::default();
    let columns = [band.window.x0, band.window.x1];
    let mut coarse: Vec<f32> = Vec::new();
    let floor = f32x8::splat(simd, FLOOR);
    for_blocks::<4>(
        band,
        #[inline(always)]
        |block, target| {
            if block.x == columns[0] {
                coarse.clear();
                coarse.extend_from_slice(upsampling.row::<4>(&pass.inputs[1], block.y, columns, false));
            }
            let at = 4 * (block.x - columns[0]) as usize;
            let mut own: [f32x8<S>; 4] = block.read(simd, &pass.inputs[0]);
            let below: [f32x8<S>; 4] = read(simd, &coarse[at..at + 32]);
            let a = anisotropy(own[0], own[1], own[2]).at_least(floor);
            let b = anisotropy(below[0], below[1], below[2]).at_least(floor);
            let share = b / (a + b);
            for (own, below) in own.iter_mut().zip(below) {
                *own = (below - *own).mul_add(share, *own);
            }
            write(own, target);
        },
    );
}
