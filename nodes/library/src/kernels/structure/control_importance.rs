//! A control map of how much places matter: less detail and fewer lines where it is little. What an artist painted adds to it.
//!
//! Cost: 30 multiply-adds per pixel.

use crate::kernels::shaders::control_importance::Params;
use crate::kernels::shared::control::sum;
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Class, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(control_importance {
    block: |simd, pass, params| |block| map(
        &params,
        block.read(simd, &pass.inputs[0]),
        if params.painted != 0 { block.read(simd, &pass.inputs[1]) } else { [f32x8::splat(simd, 0.5); 4] }
    ),
    cost: |_| 30.0,
    tolerance: Tolerance {
        absolute: 1e-5,
        relative: 1e-5,
        outliers: 1e-3,
        reason: "the smallest step is neutral or not",
    },
});

/// Importance that changes nothing.
const NEUTRAL: f32 = 0.5;
/// Growth of detail where importance is greatest, of what it falls by where there is none: too much of it is the picture
/// itself.
const MORE: f32 = 0.5;
/// Share by which lines become fewer for what detail is lost.
const FEWER: f32 = 0.6;

/// The map of an [importance](super::importance) and of what an artist painted, by a factor of 0..=1.
pub fn pass(plan: &mut PlanBuilder, importance: ImageId, painted: Option<ImageId>, strength: f32) -> ImageId {
    let params = Params { strength, painted: painted.is_some().into() };
    let images = [importance, painted.unwrap_or(importance)];
    plan.pass(&KERNEL, &images, &params, Class::Field, Support::Pixels(0))
}

#[inline(always)]
fn map<S: Simd>(params: &Params, [importance]: [f32x8<S>; 1], painted: [f32x8<S>; 4]) -> [f32x8<S>; 4] {
    let detail = (importance * (1.0 / NEUTRAL) - 1.0).within(-1.0, MORE) * params.strength;
    let (zero, lines) = (f32x8::splat(detail.simd, 0.0), detail.at_most(0.0) * FEWER);
    let [r, g, b, a] = painted;
    [sum(r, detail), sum(g, zero), sum(b, lines), sum(a, zero)]
}
