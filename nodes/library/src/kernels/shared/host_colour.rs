//! The host's pixels in its own space, finite and not premultiplied. Twin of
//! `shaders/shared/host_colour.wgsl`.

use crate::kernels::shared::coverage::unpremultiply;
use isophote_engine::fearless_simd::prelude::*;
use isophote_engine::fearless_simd::{Level, Simd, dispatch, f32x8};
use isophote_engine::math::transposed;
use isophote_engine::pixels::LARGEST_HALF;

/// The host's pixels in its own space, finite and not premultiplied. `premultiplied`: 0 they are not, 1 they are, 2
/// they are and light beyond coverage is left out.
#[inline(always)]
pub fn plain<S: Simd>(pixels: [f32x8<S>; 4], premultiplied: u32) -> [f32x8<S>; 4] {
    let [mut r, mut g, mut b, a] = finite_pixels(pixels);
    // Where all is opaque the division by 1 can be left out.
    if premultiplied == 0 || a.simd_ge(1.0).all_true() {
        return [r, g, b, a];
    }
    if premultiplied == 2 {
        let [red, green, blue] = beyond_coverage([r, g, b, a]);
        (r, g, b) = (r - red, g - green, b - blue);
    }
    unpremultiply([r, g, b, a])
}

/// Light of premultiplied colours beyond alpha / (1 - alpha)^4: straight colours of 1 where coverage is 0, of 16 where
/// it is a half, and any where it is full are within it.
///
/// The bound is wide enough for highlights along the edges of what is covered, and narrow enough that no glow
/// becomes a straight colour of thousands.
#[inline(always)]
pub fn beyond_coverage<S: Simd>([r, g, b, a]: [f32x8<S>; 4]) -> [f32x8<S>; 3] {
    let one = f32x8::splat(a.simd, 1.0);
    let share = (one - a) * (one - a);
    let most = a / (share * share).at_least(f32x8::splat(a.simd, 1e-30));
    [beyond(r, most), beyond(g, most), beyond(b, most)]
}

/// The part of a number that is further from 0 than `most`.
#[inline(always)]
fn beyond<S: Simd>(v: f32x8<S>, most: f32x8<S>) -> f32x8<S> {
    let zero = f32x8::splat(v.simd, 0.0);
    let excess = (v.abs() - most).at_least(zero);
    v.simd_lt(zero).select(-excess, excess)
}

/// Values cut to the largest half, 0 for what is not a number; alpha is cut to 0..=1.
#[inline(always)]
pub fn finite_pixels<S: Simd>([r, g, b, a]: [f32x8<S>; 4]) -> [f32x8<S>; 4] {
    let (zero, one) = (f32x8::splat(r.simd, 0.0), f32x8::splat(r.simd, 1.0));
    [finite(r), finite(g), finite(b), finite(a).at_most(one).at_least(zero)]
}

/// Values cut to the largest half, 0 for what is not a number.
#[inline(always)]
fn finite<S: Simd>(v: f32x8<S>) -> f32x8<S> {
    let largest = f32x8::splat(v.simd, LARGEST_HALF);
    v.is_nan().select(f32x8::splat(v.simd, 0.0), v.at_most(largest).at_least(-largest))
}

/// True where a premultiplied picture, four values a pixel, has light beyond its coverage ([`beyond_coverage`]).
pub fn has_light(rgba: &[f32]) -> bool {
    dispatch!(Level::new(), simd => any_light(simd, rgba))
}

#[inline(always)]
fn any_light<S: Simd>(simd: S, rgba: &[f32]) -> bool {
    let (blocks, rest) = rgba.as_chunks::<32>();
    let mut padded = [0.0; 32];
    padded[..rest.len()].copy_from_slice(rest);
    // Not by an iterator's `any`, which would be compiled for every machine.
    for block in blocks {
        if is_light_in(simd, block) {
            return true;
        }
    }
    is_light_in(simd, &padded)
}

#[inline(always)]
fn is_light_in<S: Simd>(simd: S, block: &[f32; 32]) -> bool {
    let zero = f32x8::splat(simd, 0.0);
    let pixel = |at: usize| {
        let low = [block[4 * at], block[4 * at + 1], block[4 * at + 2], block[4 * at + 3]];
        let high = [block[4 * at + 16], block[4 * at + 17], block[4 * at + 18], block[4 * at + 19]];
        f32x8::simd_from(simd, [low[0], low[1], low[2], low[3], high[0], high[1], high[2], high[3]])
    };
    let pixels = transposed([pixel(0), pixel(1), pixel(2), pixel(3)]);
    if pixels[3].simd_ge(1.0).all_true() {
        return false;
    }
    let [r, g, b] = beyond_coverage(finite_pixels(pixels));
    !(r.simd_eq(zero) & g.simd_eq(zero) & b.simd_eq(zero)).all_true()
}

/// The same for one pixel.
pub mod scalar {
    /// [`super::beyond_coverage`].
    pub fn beyond_coverage([r, g, b, a]: [f32; 4]) -> [f32; 3] {
        let share = (1.0 - a) * (1.0 - a);
        let most = a / (share * share).max(1e-30);
        [r, g, b].map(|v| v.signum() * (v.abs() - most).max(0.0))
    }
}
