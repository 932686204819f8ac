//! A painted flow map as tensors: the tangent (minor eigenvector) is the painted direction, trace and w are its
//! strength, 0..=1 (DESIGN of flow maps as game engines paint them: x in red, y in green, 0.5 for none).
//!
//! Tensors forget which way a direction points, so that strokes painted to and fro do not cancel when the field is
//! smoothed.
//!
//! Cost: about 15 operations.

pub use crate::kernels::shaders::flow_field::Params;
use crate::kernels::shared::host_colour::finite_pixels;
use crate::kernels::simd::pixels::map_pixels;
use isophote_engine::fearless_simd::{dispatch, f32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(flow_field {
    cpu: run,
    cost: |_| 15.0,
    tolerance: Tolerance {
        absolute: 1e-6,
        relative: 1e-5,
        outliers: 0.001,
        reason: "a square over itself, and the last bit of a length decides whether it stands for none",
    },
});

/// Length up to which a painted vector stands for none: eight bits have no exact half, and this is one and a half of
/// their steps.
const LEAST: f32 = 0.012;

/// (E, F, G, w) of a flow map: red and green are the direction, alpha is its strength, times `strength`.
pub fn pass(plan: &mut PlanBuilder, flow: ImageId, strength: f32, invert_y: bool) -> ImageId {
    let params = Params { strength, invert_y: invert_y.into() };
    plan.pass(&KERNEL, &[flow], &params, Class::Field, Support::Pixels(0))
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    let sign = if params.invert_y != 0 { -1.0 } else { 1.0 };
    dispatch!(pass.level, simd => map_pixels(simd, pass, band, #[inline(always)] |pixels| {
        let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
        let [r, g, _, a] = finite_pixels(pixels);
        let [r, g, a] = [r.within(zero, one), g.within(zero, one), a.within(zero, one)];
        let (x, y) = (r * 2.0 - 1.0, (g * 2.0 - 1.0) * sign);
        let square = x * x + y * y;
        let length = square.sqrt();
        let weight = (a * params.strength * length.at_most(one)).within(zero, one);
        let weight = length.simd_gt(LEAST).select(weight, zero);
        let scale = weight / square.at_least(f32x8::splat(simd, 1e-12));
        [scale * y * y, -(scale * x * y), scale * x * x, weight]
    }));
}
