//! Lightness times edge image: the input of the next iteration of the flow-based difference of
//! Gaussians, whose lines thus grow coherent (§ 4.5, 4.6).
//!
//! Cost: a multiplication per pixel.

use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Class, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(darken_by_lines {
    block: |simd, pass| |block| darkened(
        block.read(simd, &pass.inputs[0]),
        block.read(simd, &pass.inputs[1])
    ),
    cost: |_| 3.0,
    tolerance: Tolerance::of_rounding(1e-6, 1e-6, "one rounding of L"),
});

/// (L alpha, alpha) with L multiplied by the `edges` (1 = paper, 0 = line).
pub fn pass(plan: &mut PlanBuilder, lightness: ImageId, edges: ImageId) -> ImageId {
    plan.pass(&KERNEL, &[lightness, edges], &(), Class::Field, Support::Pixels(0))
}

#[inline(always)]
fn darkened<S: Simd>([l, alpha]: [f32x8<S>; 2], [edge]: [f32x8<S>; 1]) -> [f32x8<S>; 2] {
    [l * edge.within(0.0, 1.0), alpha]
}
