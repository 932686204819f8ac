//! The mean of the sectors of a disc, weighted by their variance (5.14, 5.15), for the generalized and the
//! anisotropic Kuwahara filters. Twin of `shaders/shared/sectors.wgsl`.

use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::math::Elementary;
use std::f64::consts::PI;

/// Squared distance in units of the radius up to which a pixel belongs to the disc. Pixels on the very
/// border, as a whole radius has them, must not hang on the last bit.
pub const INSIDE: f32 = 1.0005;

/// A sector of which less than this share is covered says nothing.
const SEEN: f32 = 1e-3;

/// Parameters of the polynomial weights (5.36).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Polynomial {
    /// Overlap of the sectors at the centre (5.40).
    pub zeta: f32,
    /// Overlap of the sectors at their sides (5.42).
    pub eta: f32,
}

impl Polynomial {
    /// zeta = 2 / r, and eta for gamma = 3 pi / (2 N) at that zeta.
    pub fn new(radius: f32, sectors: u32) -> Self {
        let zeta = 2.0 / f64::from(radius.max(MIN_RADIUS));
        let (sin, cos) = (1.5 * PI / f64::from(sectors)).sin_cos();
        Self { zeta: zeta as f32, eta: ((zeta + cos) / (sin * sin)) as f32 }
    }
}

/// Discs below this radius hold their centre alone.
pub const MIN_RADIUS: f32 = 0.25;

/// Statistics that eight pixels found in one of their sectors.
#[derive(Clone, Copy, Debug)]
pub struct Sector<S: Simd> {
    mean: [f32x8<S>; 3],
    /// Sum over the channels.
    variance: f32x8<S>,
    /// Share of the sector that is covered; 0 when too little is.
    cover: f32x8<S>,
}

impl<S: Simd> Sector<S> {
    /// From sums of weights times a r, a g, a b, a (r^2 + g^2 + b^2) and a, and the sum of the weights.
    #[inline(always)]
    pub fn new([r, g, b, q, a]: [f32x8<S>; 5], weights: f32x8<S>) -> Self {
        let zero = f32x8::splat(weights.simd, 0.0);
        let cover = a / weights.at_least(f32x8::splat(weights.simd, 1e-20));
        let seen = cover.simd_gt(f32x8::splat(weights.simd, SEEN));
        let n = seen.select(f32x8::splat(weights.simd, 1.0) / a, zero);
        Self::of([r, g, b, q], n, seen.select(cover, zero))
    }

    /// Of opaque pixels: their coverage is the sum of the weights. A sector is never without weight, since
    /// all share the centre.
    #[inline(always)]
    pub fn opaque(sums: [f32x8<S>; 4], weights: f32x8<S>) -> Self {
        let one = f32x8::splat(weights.simd, 1.0);
        Self::of(sums, one / weights, one)
    }

    #[inline(always)]
    fn of([r, g, b, q]: [f32x8<S>; 4], n: f32x8<S>, cover: f32x8<S>) -> Self {
        let mean = [r * n, g * n, b * n];
        let square = mean[2].mul_add(mean[2], mean[1].mul_add(mean[1], mean[0] * mean[0]));
        Self { mean, variance: (q * n - square).at_least(0.0), cover }
    }
}

/// Response by which sectors are weighed against each other.
#[derive(Clone, Copy, Debug)]
pub struct Response {
    /// tau_s of (5.15).
    pub threshold: f32,
    /// Exponent q.
    pub q: f32,
    /// tau_w: least standard deviation of a sector in the sum over sectors.
    pub floor: f32,
}

impl Response {
    /// The response (5.14), the original where nothing is covered, and the sum of the sectors' standard
    /// deviations, each at least `floor` (§ 5.5.2), as of eight sectors.
    ///
    /// Weights are taken relative to that of the flattest sector, so that no exponent overflows, and
    /// times the share of the sector that is covered.
    #[inline(always)]
    pub fn of<S: Simd, const N: usize>(
        &self,
        sectors: &[Sector<S>; N],
        original: [f32x8<S>; 4],
    ) -> ([f32x8<S>; 4], f32x8<S>) {
        let simd = original[3].simd;
        let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
        let threshold = f32x8::splat(simd, self.threshold * self.threshold);
        let floor = f32x8::splat(simd, self.floor);
        let mut least = f32x8::splat(simd, f32::MAX);
        let mut deviation = zero;
        for sector in sectors {
            let bounded = sector.variance.at_least(threshold);
            least = sector.cover.simd_gt(zero).select(least.at_most(bounded), least);
            deviation += sector.variance.sqrt().at_least(floor);
        }
        let mut alphas = [one; N];
        for k in 0..N {
            // Sectors without coverage may lie below the least of the others.
            alphas[k] = (least / sectors[k].variance.at_least(threshold)).at_most(one);
        }
        power(&mut alphas, self.q);
        let mut sum = [zero; 4];
        for k in 0..N {
            let alpha = alphas[k] * sectors[k].cover;
            for channel in 0..3 {
                sum[channel] = alpha.mul_add(sectors[k].mean[channel], sum[channel]);
            }
            sum[3] += alpha;
        }
        let seen = sum[3].simd_gt(zero);
        let n = one / seen.select(sum[3], one);
        let colour = [
            seen.select(sum[0] * n, original[0]),
            seen.select(sum[1] * n, original[1]),
            seen.select(sum[2] * n, original[2]),
            original[3],
        ];
        (colour, deviation * (8.0 / N as f32))
    }
}

/// x^(q/2) for x in 0..=1; by repeated squaring for whole q.
#[inline(always)]
fn power<S: Simd, const N: usize>(x: &mut [f32x8<S>; N], q: f32) {
    if q.fract() != 0.0 {
        for x in x {
            *x = x.powf(0.5 * q);
        }
        return;
    }
    let whole = q as u32;
    let (mut rest, mut squares) = (whole >> 1, *x);
    for x in &mut *x {
        *x = if whole & 1 != 0 { x.sqrt() } else { f32x8::splat(x.simd, 1.0) };
    }
    while rest != 0 {
        if rest & 1 != 0 {
            for k in 0..N {
                x[k] *= squares[k];
            }
        }
        for square in &mut squares {
            *square *= *square;
        }
        rest >>= 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eta_is_that_of_the_thesis_at_radius_six() {
        assert!((Polynomial::new(6.0, 4).eta - 0.84).abs() < 0.005);
        assert!((Polynomial::new(6.0, 8).eta - 3.77).abs() < 0.005);
    }
}
