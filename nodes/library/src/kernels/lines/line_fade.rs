//! Lines as strong as a map of opacities lets them be.
//!
//! Cost: a multiplication per pixel.

use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Class, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(line_fade {
    block: |simd, pass| |block| faded(block.read(simd, &pass.inputs[0]), block.read(simd, &pass.inputs[1])),
    cost: |_| 4.0,
    tolerance: Tolerance::of_rounding(1e-6, 1e-6, "two roundings of a share"),
});

/// Edges (1 = paper, 0 = line) of which each pixel keeps the share in the alpha of `opacity`.
pub fn pass(plan: &mut PlanBuilder, edges: ImageId, opacity: ImageId) -> ImageId {
    plan.pass(&KERNEL, &[edges, opacity], &(), Class::Field, Support::Pixels(0))
}

#[inline(always)]
fn faded<S: Simd>([edge]: [f32x8<S>; 1], [_, _, _, opacity]: [f32x8<S>; 4]) -> [f32x8<S>; 1] {
    let one = f32x8::splat(edge.simd, 1.0);
    [one - (one - edge.within(0.0, 1.0)) * opacity.within(0.0, 1.0)]
}
