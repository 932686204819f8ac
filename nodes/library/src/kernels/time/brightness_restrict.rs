//! Brightness at half the resolution: the mean of four pixels. At odd sizes the last ones, clamped, count twice,
//! which leaves the mean of those that exist.
//!
//! Cost: 4 operations.

use crate::kernels::simd::pixels::{BLOCK, read, write};
use isophote_engine::fearless_simd::Simd;
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(brightness_restrict {
    cpu: |simd, pass, band| means(simd, pass, band),
    cost: |_| 4.0,
    tolerance: Tolerance::of_rounding(1e-7, 1e-6, "a sum of four in the same order"),
});

/// Adds the pass: from the image's level to the next coarser one, ceil(n / 2) pixels on a side.
pub fn pass(plan: &mut PlanBuilder, brightness: ImageId) -> ImageId {
    let level = plan.desc(brightness).level + 1;
    plan.pass_at(&KERNEL, &[brightness], &(), &[Class::Field], Support::Pixels(0), level)
}

#[inline(always)]
fn means<S: Simd>(simd: S, pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let window = band.window;
    let view = &pass.inputs[0];
    let columns = [2 * window.x0, 2 * window.x1];
    let (mut scratch, mut other) = (Vec::new(), Vec::new());
    for y in window.y0..window.y1 {
        let upper = view.padded_row(2 * y, columns[0], columns[1], &mut scratch);
        let lower = view.padded_row(2 * y + 1, columns[0], columns[1], &mut other);
        let target = band.row_mut(0, y);
        let mut x = 0;
        while x < target.len() {
            // Pairs of neighbours are read as the two channels of a pixel.
            let [a, b] = read(simd, &upper[2 * x..]);
            let [c, d] = read(simd, &lower[2 * x..]);
            let end = (x + BLOCK).min(target.len());
            write([((a + b) + (c + d)) * 0.25], &mut target[x..end]);
            x += BLOCK;
        }
    }
}
