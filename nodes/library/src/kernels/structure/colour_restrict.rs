//! A colour at half the resolution, for the pyramid of the multi-scale estimation (§ 2.8): the mean of
//! four pixels by their coverage. At odd sizes the missing children count for nothing.
//!
//! Cost: 4 additions and a division on four channels.

use crate::kernels::shared::coverage::LEAST_COVERAGE;
use crate::kernels::simd::children::for_children;
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
    for_children(
        &pass.inputs[0],
        band,
        #[inline(always)]
        |upper, lower, target| {
            let (mut sum, mut coverage, mut count) = (f32x4::splat(simd, 0.0), 0.0, 0.0);
            for p in upper.chunks_exact(4).chain(lower.chunks_exact(4)) {
                sum += f32x4::from_slice(simd, p) * p[3];
                coverage += p[3];
                count += 1.0f32;
            }
            let color = if coverage > LEAST_COVERAGE { sum / coverage } else { f32x4::splat(simd, 0.0) };
            color.store_slice(target);
            target[3] = coverage / count;
        },
    );
}
