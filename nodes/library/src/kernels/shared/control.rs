//! Factors of control maps, by which artists direct places of a picture: 0.5 changes nothing. Twin of
//! `shaders/shared/control.wgsl`.

use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::math::Elementary;

/// Distance from 0.5 that is neutral: eight bits have no exact half, and this is more than half of their step.
const NEUTRAL: f32 = 0.0021;

/// Number of a control map that stands for a factor of 1/4 to 4.
pub fn value_of(factor: f32) -> f32 {
    let step = factor.log2() / 2.0;
    let past = 0.5 + step * (0.5 - NEUTRAL) + NEUTRAL.copysign(step);
    // Rounding may lead out of a map's range, where numbers say nothing.
    if step == 0.0 { 0.5 } else { past.clamp(0.0, 1.0) }
}

/// A channel of a control map as -1..=1, 0 where it is neutral or not a number.
#[inline(always)]
pub fn step<S: Simd>(value: f32x8<S>) -> f32x8<S> {
    let (zero, half) = (f32x8::splat(value.simd, 0.0), f32x8::splat(value.simd, 0.5));
    let v = value.is_nan().select(half, value.within(0.0, 1.0)) - half;
    let past = (v.abs() - NEUTRAL).at_least(zero) * (1.0 / (0.5 - NEUTRAL));
    v.simd_lt(zero).select(-past, past)
}

/// A channel with so many steps more, -1..=1.
#[inline(always)]
pub fn sum<S: Simd>(value: f32x8<S>, more: f32x8<S>) -> f32x8<S> {
    let zero = f32x8::splat(value.simd, 0.0);
    let step = (step(value) + more).within(-1.0, 1.0);
    let sign = step.simd_lt(zero).select(zero - NEUTRAL, zero + NEUTRAL);
    step.simd_eq(zero).select(zero + 0.5, step * (0.5 - NEUTRAL) + 0.5 + sign)
}

/// Factors of 1/4 to 4 of a channel, exactly 1 where it is neutral.
#[inline(always)]
pub fn factor<S: Simd>(value: f32x8<S>) -> f32x8<S> {
    let step = step(value);
    let one = f32x8::splat(value.simd, 1.0);
    step.simd_eq(f32x8::splat(value.simd, 0.0)).select(one, (step * 2.0).exp2())
}
