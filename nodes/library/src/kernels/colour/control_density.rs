//! Light that a medium lets through where a control map says how much of it there is: densities add up, so that light is
//! raised to the factor of the map's fourth channel (Bouguer, Beer and Lambert).
//!
//! Cost: three logarithms and four exponentials per pixel.

use crate::kernels::shared::control::factor;
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::math::Elementary;
use isophote_engine::{Class, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(control_density {
    block: |simd, pass| |block| denser(block.read(simd, &pass.inputs[0]), block.read(simd, &pass.inputs[1])),
    cost: |_| 120.0,
    tolerance: Tolerance::of_rounding(2e-6, 2e-5, "a logarithm times four, through an exponential"),
});

/// A picture RGBA, 1 for bare paper, under a control map.
pub fn pass(plan: &mut PlanBuilder, source: ImageId, control: ImageId) -> ImageId {
    plan.pass(&KERNEL, &[source, control], &(), Class::Colour, Support::Pixels(0))
}

#[inline(always)]
fn denser<S: Simd>(source: [f32x8<S>; 4], control: [f32x8<S>; 4]) -> [f32x8<S>; 4] {
    let simd = source[0].simd;
    let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
    let factor = factor(control[3]);
    let changes = !factor.simd_eq(one);
    let mut result = source;
    for c in 0..3 {
        let light = source[c].within(1e-6, 1.0);
        let darker = (light.ln() * factor).exp();
        // Where nothing or all is let through, light stays as it is.
        let between = changes & source[c].simd_gt(zero) & source[c].simd_lt(one);
        result[c] = between.select(darker, source[c]);
    }
    result
}
