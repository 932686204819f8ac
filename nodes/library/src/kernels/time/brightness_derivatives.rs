//! The derivatives that the variational refinement needs (Kroeger et al. 2016, 3.3; Brox et al. 2004, 3.1): x, y, z of
//! the brightness, where z is from here to there, and of its gradient, by central differences.
//!
//! Cost: 25 operations.

use crate::kernels::simd::around::{Around, rows};
use crate::kernels::simd::pixels::{BLOCK, Block};
use isophote_engine::fearless_simd::{Simd, f32x8};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

/// Levels of brightness to 1.
const LEVELS: f32 = 255.0;

crate::kernel!(brightness_derivatives {
    cpu: |simd, pass, band| derivatives(simd, pass, band),
    cost: |_| 25.0,
    tolerance: Tolerance::of_rounding(
        1e-3,
        1e-6,
        "differences in the same order, of brightness up to 4 in levels of 1/255: one in its last bit"
    ),
});

/// The derivatives x, y, z and xx, and xy, yy, xz and yz, in levels of brightness; of what
/// [`brightness_warp`](super::brightness_warp) gives.
pub fn pass(plan: &mut PlanBuilder, warped: [ImageId; 2]) -> [ImageId; 2] {
    let level = plan.desc(warped[0]).level;
    let first = plan.pass_at(&KERNEL, &warped, &(), &[Class::Field; 2], Support::Pixels(1), level);
    [first, plan.sibling(first, 1)]
}

/// Numbers of 0 to 1 in levels of eight bits.
#[inline(always)]
fn in_levels<S: Simd>([a, b, c, d]: [f32x8<S>; 4]) -> [f32x8<S>; 4] {
    [a * LEVELS, b * LEVELS, c * LEVELS, d * LEVELS]
}

#[inline(always)]
fn derivatives<S: Simd>(simd: S, pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let window = band.window;
    let mut scratch: [[Vec<f32>; 3]; 2] = Default::default();
    for y in window.y0..window.y1 {
        let [of_mean, of_difference] = &mut scratch;
        let means = rows(&pass.inputs[0], y, window, of_mean);
        let differences = rows(&pass.inputs[1], y, window, of_difference);
        for x in (window.x0..window.x1).step_by(BLOCK) {
            let block = Block::until(window.x1, x, y);
            let around = Around::<1> { rows: means, at: (x - window.x0) as usize, len: block.len };
            let other = Around { rows: differences, ..around };
            let ([left], [right]) = (around.value(simd, -1, 0), around.value(simd, 1, 0));
            let ([up], [down]) = (around.value(simd, 0, -1), around.value(simd, 0, 1));
            let twice = around.value(simd, 0, 0)[0] * 2.0;
            let falling = around.value(simd, 1, 1)[0] + around.value(simd, -1, -1)[0];
            let rising = around.value(simd, 1, -1)[0] + around.value(simd, -1, 1)[0];
            let xz = other.value(simd, 1, 0)[0] - other.value(simd, -1, 0)[0];
            let yz = other.value(simd, 0, 1)[0] - other.value(simd, 0, -1)[0];
            let (xx, yy) = (right - twice + left, down - twice + up);
            let z = other.value(simd, 0, 0)[0];
            let first = [(right - left) * 0.5, (down - up) * 0.5, z, xx];
            let second = [(falling - rising) * 0.25, yy, xz * 0.5, yz * 0.5];
            block.write(in_levels(first), band, 0);
            block.write(in_levels(second), band, 1);
        }
    }
}
