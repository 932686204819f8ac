//! Response of a line filter with more or fewer lines, as a control map says: differences from the lightness beneath count by
//! the factor of its third channel, which is what a factor on 1 - `tau` comes to (4.9), and not at all where it is 0.
//!
//! Cost: an exponential per pixel.

pub use crate::kernels::shaders::line_amount::Params;
use crate::kernels::shared::control::{factor, step};
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Class, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(line_amount {
    block: |simd, pass, params| |block| directed(
        &params,
        block.read(simd, &pass.inputs[0]),
        block.read(simd, &pass.inputs[1]),
        block.read(simd, &pass.inputs[2])
    ),
    cost: |_| 25.0,
    tolerance: Tolerance::of_rounding(
        1e-3,
        1e-5,
        "a difference of highlights of hundreds of L, times up to four"
    ),
});

/// Share of the way from 0 to neutral over which lines fade to none.
const FADE: f32 = 0.25;

/// (u alpha, alpha) of a response, of which lightness (L alpha, alpha) has the weight `base`, under a control map.
pub fn pass(plan: &mut PlanBuilder, images: [ImageId; 3], base: f32) -> ImageId {
    let params = Params { base, fade: 1.0 / FADE };
    plan.pass(&KERNEL, &images, &params, Class::Field, Support::Pixels(0))
}

#[inline(always)]
fn directed<S: Simd>(
    params: &Params,
    [u, alpha]: [f32x8<S>; 2],
    [l, _]: [f32x8<S>; 2],
    control: [f32x8<S>; 4],
) -> [f32x8<S>; 2] {
    let share = ((step(control[2]) + 1.0) * params.fade).at_most(1.0);
    let difference = u - l * params.base;
    [u + difference * (factor(control[2]) * share - 1.0), alpha]
}
