//! The host's pixels in its own space, finite and not premultiplied. Twin of
//! `shaders/shared/host_colour.wgsl`.

use crate::kernels::simd::pixels::unpremultiply;
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::pixels::LARGEST_HALF;

/// The host's pixels in its own space, finite and not premultiplied.
#[inline(always)]
pub fn plain<S: Simd>([r, g, b, a]: [f32x8<S>; 4], premultiplied: bool) -> [f32x8<S>; 4] {
    let (zero, one) = (f32x8::splat(r.simd, 0.0), f32x8::splat(r.simd, 1.0));
    let (r, g, b) = (finite(r), finite(g), finite(b));
    let a = finite(a).min(one).max(zero);
    // Where all is opaque the division by 1 can be left out.
    if premultiplied && !a.simd_ge(one).all_true() {
        return unpremultiply([r, g, b, a]);
    }
    [r, g, b, a]
}

/// Values cut to the largest half, 0 for what is not a number.
#[inline(always)]
fn finite<S: Simd>(v: f32x8<S>) -> f32x8<S> {
    let largest = f32x8::splat(v.simd, LARGEST_HALF);
    v.is_nan().select(f32x8::splat(v.simd, 0.0), v.min(largest).max(-largest))
}
