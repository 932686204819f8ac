//! Orientation of a tensor, (E - G, F) (2.82): both are linear, so that interpolation
//! commutes, and stream lines load half as much. Read as a tensor whose G is 0 it has the same
//! eigenvectors.
//!
//! Cost: a subtraction per pixel.

use isophote_engine::fearless_simd::{Simd, f32x8};
use isophote_engine::{Class, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(orientation_field {
    block: |simd, pass| |block| orientation(block.read(simd, &pass.inputs[0])),
    cost: |_| 1.0,
    tolerance: Tolerance::of_rounding(1e-7, 1e-6, "two roundings"),
});

/// (E - G, F) of a tensor image.
pub fn pass(plan: &mut PlanBuilder, tensor: ImageId) -> ImageId {
    plan.pass(&KERNEL, &[tensor], &(), Class::Field, Support::Pixels(0))
}

#[inline(always)]
fn orientation<S: Simd>([e, f, g, _]: [f32x8<S>; 4]) -> [f32x8<S>; 2] {
    [e - g, f]
}
