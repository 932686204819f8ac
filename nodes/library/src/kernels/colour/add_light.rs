//! A premultiplied picture and light that is added to it; coverage stays.
//!
//! Cost: three additions per pixel.

use isophote_engine::fearless_simd::{Simd, f32x8};
use isophote_engine::{Class, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(add_light {
    block: |simd, pass| |block| lit(block.read(simd, &pass.inputs[0]), block.read(simd, &pass.inputs[1])),
    cost: |_| 3.0,
    tolerance: Tolerance::of_rounding(1e-7, 1e-6, "one rounding"),
});

/// Adds the pass.
pub fn pass(plan: &mut PlanBuilder, picture: ImageId, light: ImageId) -> ImageId {
    plan.pass(&KERNEL, &[picture, light], &(), Class::Colour, Support::Pixels(0))
}

#[inline(always)]
fn lit<S: Simd>(under: [f32x8<S>; 4], light: [f32x8<S>; 4]) -> [f32x8<S>; 4] {
    [under[0] + light[0], under[1] + light[1], under[2] + light[2], under[3]]
}
