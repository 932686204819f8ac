//! A picture between one and another, whose difference counts by the factor of a channel of a control map.
//!
//! Cost: an exponential per pixel.

pub use crate::kernels::shaders::control_difference::Params;
use crate::kernels::shared::control::factor;
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Class, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(control_difference {
    block: |simd, pass, params| |block| weighed(
        &params,
        block.read(simd, &pass.inputs[0]),
        block.read(simd, &pass.inputs[1]),
        block.read(simd, &pass.inputs[2])
    ),
    cost: |_| 30.0,
    tolerance: Tolerance::of_rounding(1e-5, 1e-5, "an exponential times a difference"),
});

/// `first` + factor (`second` - `first`) of two pictures of four channels, under a control map.
pub fn pass(
    plan: &mut PlanBuilder,
    [first, second]: [ImageId; 2],
    control: ImageId,
    params: &Params,
) -> ImageId {
    plan.pass(&KERNEL, &[first, second, control], params, Class::Colour, Support::Pixels(0))
}

#[inline(always)]
fn weighed<S: Simd>(
    params: &Params,
    first: [f32x8<S>; 4],
    second: [f32x8<S>; 4],
    control: [f32x8<S>; 4],
) -> [f32x8<S>; 4] {
    let value = (control[params.channel as usize % 4] - 0.5) * params.sense + 0.5;
    let more = factor(value).at_most(params.most) - 1.0;
    let mut result = second;
    for c in 0..4 {
        // Where nothing changes, not the last bit does.
        result[c] = second[c] + (second[c] - first[c]) * more;
    }
    result
}
