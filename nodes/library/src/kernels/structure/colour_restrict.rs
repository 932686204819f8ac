//! A colour at half the resolution, for the pyramid of the multi-scale estimation (§ 2.8): the mean of
//! four pixels by their coverage. At odd sizes the missing children count for nothing.
//!
//! Cost: 4 additions and a division on four channels.

use crate::kernels::shared::coverage::LEAST_COVERAGE;
use isophote_engine::fearless_simd::{Simd, f32x4, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(colour_restrict {
    cpu: |simd, pass, band| means(simd, pass, band),
    cost: |_| 24.0,
    tolerance: Tolerance::of_rounding(1e-7, 2e-6, "three additions in the same order and a division"),
});

/// Adds the pass: from the image's level to the next coarser one, ceil(n / 2) pixels on a side.
pub fn pass(plan: &mut PlanBuilder, color: ImageId) -> ImageId {
    let level = plan.desc(color).level + 1;
    plan.pass_at(&KERNEL, &[color], &(), &[Class::Colour], Support::Pixels(0), level)
}

#[inline(always)]
fn means<S: Simd>(simd: S, pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let window = band.window;
    let view = &pass.inputs[0];
    let [width, height] = view.full();
    let len = 4 * ((2 * window.x1).min(width) - 2 * window.x0) as usize;
    for y in window.y0..window.y1 {
        let at = view.offset(2 * window.x0, 2 * y);
        let upper = view.data()[at..at + len].chunks(8);
        // The row below the last of an odd picture is no row: its pixels are left out.
        let lower = if 2 * y + 1 < height {
            let at = view.offset(2 * window.x0, 2 * y + 1);
            &view.data()[at..at + len]
        } else {
            &[]
        };
        let lower = lower.chunks(8).chain(std::iter::repeat(&[][..]));
        for ((upper, lower), target) in upper.zip(lower).zip(band.row_mut(0, y).chunks_exact_mut(4)) {
            let (mut sum, mut coverage, mut count) = (f32x4::splat(simd, 0.0), 0.0, 0.0);
            for p in upper.chunks_exact(4).chain(lower.chunks_exact(4)) {
                sum += f32x4::from_slice(simd, p) * p[3];
                coverage += p[3];
                count += 1.0f32;
            }
            let color = if coverage > LEAST_COVERAGE { sum / coverage } else { f32x4::splat(simd, 0.0) };
            color.store_slice(target);
            target[3] = coverage / count;
        }
    }
}
