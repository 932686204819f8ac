//! Orientation of a picture with a factor for each pixel, of a channel of a control map, in the fourth channel: what lines
//! and smoothing read along with the direction that they follow. The thesis has one value of each parameter for the whole
//! picture; artists direct places.
//!
//! Cost: an exponential per pixel.

pub use crate::kernels::shaders::control_field::Params;
use crate::kernels::shared::control::factor;
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Class, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(control_field {
    block: |simd, pass, params| |block| with_factor(
        &params,
        block.read(simd, &pass.inputs[0]),
        block.read(simd, &pass.inputs[1])
    ),
    cost: |_| 20.0,
    tolerance: Tolerance::of_rounding(1e-6, 4e-6, "an exponential, exact to some units in the last place"),
});

/// (E - G, F, 0, factor) of an [orientation field](super::orientation_field) and a control map, four values a pixel.
pub fn pass(plan: &mut PlanBuilder, field: ImageId, control: ImageId, params: &Params) -> ImageId {
    plan.pass(&KERNEL, &[field, control], params, Class::Field, Support::Pixels(0))
}

#[inline(always)]
fn with_factor<S: Simd>(
    params: &Params,
    [difference, f]: [f32x8<S>; 2],
    control: [f32x8<S>; 4],
) -> [f32x8<S>; 4] {
    let zero = f32x8::splat(f.simd, 0.0);
    let value = (control[params.channel as usize % 4] - 0.5) * params.sense + 0.5;
    [difference, f, zero, factor(value).at_least(params.least)]
}
