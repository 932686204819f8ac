//! Tones that marks and their grain begin at. Twin of `shaders/shared/mark_tones.wgsl`.

use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};

/// Lightness from which on tones are smooth.
pub const SMOOTH_FROM: f32 = 69.0;
/// One over the units of L below it over which marks stand out.
pub const INVERSE_FADE: f32 = 1.0 / 9.0;

/// Ramp from 0 to 1.
#[inline(always)]
pub fn rise<S: Simd>(t: f32x8<S>) -> f32x8<S> {
    let t = t.within(0.0, 1.0);
    t * t * (t * -2.0 + 3.0)
}

/// Lightness of (L alpha, alpha); that of paper where nothing is covered.
#[inline(always)]
pub fn tone_lightness<S: Simd>([sum, alpha]: [f32x8<S>; 2]) -> f32x8<S> {
    let (covered, one) = (alpha.simd_gt(1e-4), f32x8::splat(sum.simd, 1.0));
    covered.select(sum / covered.select(alpha, one), one * 100.0)
}
