//! A colour axis of CIELAB and coverage, (a alpha, alpha) or (b alpha, alpha), for line filters.
//!
//! Cost: a multiplication per pixel.

pub use crate::kernels::shaders::lab_channel::Params;
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Class, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(lab_channel {
    block: |simd, pass, params| |block| channel(&params, block.read(simd, &pass.inputs[0])),
    cost: |_| 1.0,
    tolerance: Tolerance::of_rounding(1e-7, 1e-6, "one rounding"),
});

/// Farthest from grey that counts: colours of surfaces are no farther, and light beyond white would drown them.
const MOST: f32 = 128.0;

/// The axis a (0) or b (1) of a Lab image.
pub fn pass(plan: &mut PlanBuilder, lab: ImageId, axis: u32) -> ImageId {
    plan.pass(&KERNEL, &[lab], &Params { axis }, Class::Colour, Support::Pixels(0))
}

#[inline(always)]
fn channel<S: Simd>(params: &Params, [_, a, b, alpha]: [f32x8<S>; 4]) -> [f32x8<S>; 2] {
    let v = if params.axis == 1 { b } else { a };
    [v.within(-MOST, MOST) * alpha, alpha]
}
