//! Lightness times edge image: the input of the next iteration of the flow-based difference of
//! Gaussians, whose lines thus grow coherent (§ 4.5, 4.6).
//!
//! Cost: a multiplication per pixel.

use crate::kernels::simd::pixels::{for_blocks, write};
use isophote_engine::fearless_simd::{dispatch, f32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(darken_by_lines {
    cpu: run,
    cost: |_| 3.0,
    tolerance: Tolerance::of_rounding(1e-6, 1e-6, "one rounding of L"),
});

/// (L alpha, alpha) with L multiplied by the `edges` (1 = paper, 0 = line).
pub fn pass(plan: &mut PlanBuilder, lightness: ImageId, edges: ImageId) -> ImageId {
    plan.pass(&KERNEL, &[lightness, edges], &(), Class::Field, Support::Pixels(0))
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let (lightness, edges) = (&pass.inputs[0], &pass.inputs[1]);
    dispatch!(pass.level, simd => for_blocks::<2>(band, #[inline(always)] |block, target| {
        let [l, alpha] = block.read(simd, lightness);
        let [edge]: [f32x8<_>; 1] = block.read(simd, edges);
        write([l * edge.within(0.0, 1.0), alpha], target);
    }));
}
