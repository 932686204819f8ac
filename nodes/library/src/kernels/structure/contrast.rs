//! Stretches contrast about middle grey and clamps to 0..=1; alpha passes. Averages of noise along
//! stream lines (§ 2.9) are made visible with it.
//!
//! Cost: one multiply-add a value.

pub use crate::kernels::shaders::contrast::Params;
use crate::kernels::simd::pixels::map_pixels;
use isophote_engine::fearless_simd::{dispatch, f32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(contrast {
    cpu: run,
    cost: |_| 4.0,
    tolerance: Tolerance::of_rounding(2e-6, 0.0, "three roundings of values up to 1"),
});

/// Adds the pass: 0.5 + gain (colour - 0.5), clamped.
pub fn pass(plan: &mut PlanBuilder, color: ImageId, gain: f32) -> ImageId {
    plan.pass(&KERNEL, &[color], &Params { gain }, Class::Colour, Support::Pixels(0))
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    dispatch!(pass.level, simd => map_pixels(simd, pass, band, #[inline(always)] |[r, g, b, a]| {
        let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
        let mut rgb = [r, g, b];
        for v in &mut rgb {
            *v = ((*v - 0.5) * params.gain + 0.5).within(zero, one);
        }
        [rgb[0], rgb[1], rgb[2], a]
    }));
}
