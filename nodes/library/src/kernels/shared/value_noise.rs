//! Smooth noise from hashed cells: the texture of papers and paint; the twin of
//! `shaders/shared/value_noise.wgsl`.
//!
//! Cost: four hashes and about 40 operations.

use isophote_engine::fearless_simd::{Simd, f32x8, i32x8, prelude::*, u32x8};

/// Smooth noise in 0..=1 with cells of one unit.
#[inline(always)]
pub fn noise<S: Simd>(simd: S, x: f32x8<S>, y: f32x8<S>, seed: u32) -> f32x8<S> {
    let (cx, cy) = (x.floor(), y.floor());
    let (sx, sy) = (smooth(x - cx), smooth(y - cy));
    let (ix, iy): (i32x8<S>, i32x8<S>) = (cx.to_int(), cy.to_int());
    let ix = ix.bitcast::<u32x8<S>>() + u32x8::splat(simd, seed);
    let iy = iy.bitcast::<u32x8<S>>();
    let one = u32x8::splat(simd, 1);
    let top = mix(hash(ix, iy), hash(ix + one, iy), sx);
    let bottom = mix(hash(ix, iy + one), hash(ix + one, iy + one), sx);
    mix(top, bottom, sy)
}

#[inline(always)]
fn smooth<S: Simd>(f: f32x8<S>) -> f32x8<S> {
    f * f * (f * -2.0 + 3.0)
}

#[inline(always)]
fn mix<S: Simd>(a: f32x8<S>, b: f32x8<S>, t: f32x8<S>) -> f32x8<S> {
    let rest = f32x8::splat(t.simd, 1.0) - t;
    a * rest + b * t
}

/// A number in 0..1 that belongs to a cell.
#[inline(always)]
fn hash<S: Simd>(x: u32x8<S>, y: u32x8<S>) -> f32x8<S> {
    let (a, b) = (u32x8::splat(x.simd, 0x9e37_79b1), u32x8::splat(x.simd, 0x85eb_ca77));
    let (c, d) = (u32x8::splat(x.simd, 0x2c1b_3c6d), u32x8::splat(x.simd, 0x297a_2d39));
    let h = (x * a) ^ (y * b);
    let h = (h ^ (h >> 15)) * c;
    let h = (h ^ (h >> 12)) * d;
    let h = h ^ (h >> 15);
    let kept: i32x8<S> = (h >> 8).bitcast();
    kept.to_float::<f32x8<S>>() * 5.960_464_5e-8
}
