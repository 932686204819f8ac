//! Brightness of the other picture by a motion field: the mean of a pixel's brightness and that of the place it moves
//! to, and their difference, that there less that here.
//!
//! Cost: a bilinear sample, about 20 operations.

use crate::kernels::shared::sampling::sample_linear1;
use crate::kernels::simd::pixels::{BLOCK, Block};
use isophote_engine::fearless_simd::Simd;
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(brightness_warp {
    cpu: |simd, pass, band| warp(simd, pass, band),
    cost: |_| 20.0,
    tolerance: Tolerance {
        absolute: 2e-5,
        relative: 2e-6,
        outliers: 0.001,
        reason: "positions have fewer bits of fraction the farther they lie from the corner, and the brightness of \
                 broken pictures jumps by 4 from pixel to pixel",
    },
});

/// The mean and the difference, after `motion`, which is at most `reach` pixels long along x and along y.
pub fn pass(
    plan: &mut PlanBuilder,
    [here, there]: [ImageId; 2],
    motion: ImageId,
    reach: u32,
) -> [ImageId; 2] {
    let level = plan.desc(motion).level;
    // One pixel more for the interpolation, and one for the sum's rounding.
    let support = Support::Pixels(reach + 2);
    let classes = [Class::Field; 2];
    let mean = plan.pass_at(&KERNEL, &[here, there, motion], &(), &classes, support, level);
    [mean, plan.sibling(mean, 1)]
}

#[inline(always)]
fn warp<S: Simd>(simd: S, pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let window = band.window;
    let [here, there, motion] = [&pass.inputs[0], &pass.inputs[1], &pass.inputs[2]];
    for y in window.y0..window.y1 {
        for x in (window.x0..window.x1).step_by(BLOCK) {
            let block = Block::until(window.x1, x, y);
            let [origin] = block.read(simd, here);
            let [dx, dy] = block.read(simd, motion);
            let [column, row] = block.centres(simd);
            let moved = sample_linear1(simd, there, column + dx, row + dy);
            block.write([(origin + moved) * 0.5], band, 0);
            block.write([moved - origin], band, 1);
        }
    }
}
