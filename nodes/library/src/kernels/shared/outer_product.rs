//! The structure tensor of one pixel's gradient and its validity (2.34, 2.133, 2.164). Twin of
//! `shaders/shared/outer_product.wgsl`.

use crate::kernels::shared::tensor::axis;
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};

/// The tensor (2.34) and its validity.
#[inline(always)]
pub fn outer_product<S: Simd>(
    simd: S,
    flags: u32,
    scale: f32,
    threshold: f32,
    centre: [f32x8<S>; 4],
    gradients: [[f32x8<S>; 2]; 4],
) -> [f32x8<S>; 4] {
    let zero = f32x8::splat(simd, 0.0);
    let [.., alpha] = centre;
    // The quotient rule without its division: coverage squared times the gradient of the colour.
    let (mut x, mut y) = ([zero; 3], [zero; 3]);
    for c in 0..3 {
        x[c] = (alpha * gradients[c][0] - centre[c] * gradients[3][0]) * scale;
        y[c] = (alpha * gradients[c][1] - centre[c] * gradients[3][1]) * scale;
    }
    if flags & 1 != 0 {
        x = [x[0] * 0.2126 + x[1] * 0.7152 + x[2] * 0.0722, zero, zero];
        y = [y[0] * 0.2126 + y[1] * 0.7152 + y[2] * 0.0722, zero, zero];
    }
    let (mut e, mut f, mut g) = (zero, zero, zero);
    for c in 0..3 {
        let (mut xx, mut xy, mut yy) = (x[c] * x[c], x[c] * y[c], y[c] * y[c]);
        if flags & 2 != 0 {
            let inverse = f32x8::splat(simd, 1.0) / (xx + yy).at_least(f32x8::splat(simd, 1e-30)).sqrt();
            (xx, xy, yy) = (xx * inverse, xy * inverse, yy * inverse);
        }
        (e, f, g) = (e + xx, f + xy, g + yy);
    }
    [e, f, g, validity(simd, threshold, e, f, g)]
}

/// 1 where lambda1 is above `threshold`, else 0 (2.164).
#[inline(always)]
pub fn validity<S: Simd>(simd: S, threshold: f32, e: f32x8<S>, f: f32x8<S>, g: f32x8<S>) -> f32x8<S> {
    let one = f32x8::splat(simd, 1.0);
    if threshold < 0.0 {
        return one;
    }
    let lambda1 = (e + g) * 0.5 + axis((e - g) * 0.5, f).0;
    lambda1.simd_gt(f32x8::splat(simd, threshold)).select(one, f32x8::splat(simd, 0.0))
}
