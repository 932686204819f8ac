//! From the response of a difference of Gaussians to an edge image (§ 4.3, 4.4): 1 is paper, 0 is
//! line. Twin of `shaders/shared/edge_threshold.wgsl`.

use crate::kernels::shared::coverage::LEAST_COVERAGE;
use isophote_engine::fearless_simd::{Simd, f32x8, mask32x8, prelude::*};
use isophote_engine::math::Elementary;

crate::declare::choice::choice! {
    /// Threshold that makes an edge image of a response.
    pub enum Threshold {
        /// Not at all: the response of the filter as it is.
        None = 0 ("none", "Not cut"),
        /// Paper or line, nothing between.
        Binary = 1 ("binary", "Hard"),
        /// A soft ramp into the line.
        Tanh = 2 ("tanh", "Soft"),
        /// A soft ramp that also ends softly in the dark.
        Smoothstep = 3 ("smoothstep", "Soft on both sides"),
    }
}

/// Weights and threshold of an extended difference of Gaussians, in the one form that both
/// parameterisations come to: the response is base G_sigma + edge (G_sigma - G_k sigma) (4.9).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Xdog {
    /// Weight of the smoothed lightness: 1 - tau, or 1.
    pub base: f32,
    /// Weight of the difference of Gaussians: tau, or p.
    pub edge: f32,
    /// Response from which on there is no line, units of L.
    pub epsilon: f32,
    /// Steepness of the ramp, per unit of L.
    pub phi: f32,
    /// The curve.
    pub threshold: Threshold,
    /// Share of the paper that shows through lines, 0..1: those that are to be narrower than a pixel are so much fainter.
    pub faintness: f32,
}

impl Xdog {
    /// The original parameters: inhibition `tau` 0..=1 (4.7), level `epsilon`, steepness `phi` (4.8).
    pub fn tau(tau: f32, epsilon: f32, phi: f32, threshold: Threshold) -> Self {
        Self { base: 1.0 - tau, edge: tau, epsilon, phi, threshold, faintness: 0.0 }
    }

    /// The sharpening form (4.10): strength `p` = tau / (1 - tau), level and steepness on the scale
    /// of the image.
    pub fn sharpen(p: f32, epsilon: f32, phi: f32, threshold: Threshold) -> Self {
        Self { base: 1.0, edge: p, epsilon, phi, threshold, faintness: 0.0 }
    }
}

/// The edge image of response `u`; see [`Threshold`].
#[inline(always)]
pub fn edge_threshold<S: Simd>(u: f32x8<S>, kind: u32, epsilon: f32, phi: f32) -> f32x8<S> {
    let (zero, one) = (f32x8::splat(u.simd, 0.0), f32x8::splat(u.simd, 1.0));
    if kind == Threshold::None as u32 {
        return u;
    }
    let paper = u.simd_ge(epsilon);
    if paper.all_true() {
        return one;
    }
    let x = ((u - epsilon) * phi).within(-20.0, 0.0);
    let below = if kind == Threshold::Binary as u32 {
        zero
    } else if kind == Threshold::Tanh as u32 {
        // 1 + tanh(x), whose absolute error is what shows.
        let e = (x * (2.0 * std::f32::consts::LOG2_E)).exp2_falling();
        (e + e) / (e + 1.0)
    } else {
        let t = (x * 0.25 + 0.5).at_least(0.0);
        t * 2.0 * t * (t * -2.0 + 3.0)
    };
    paper.select(one, below)
}

/// An edge image through whose lines a share of the paper shows; the same to the bit for none.
#[inline(always)]
pub fn fainter<S: Simd>(edge: f32x8<S>, faintness: f32) -> f32x8<S> {
    edge + (f32x8::splat(edge.simd, 1.0) - edge) * faintness
}

/// The edge image of response `u`, its lines as faint as they are to be; the response itself where there is no threshold.
#[inline(always)]
pub fn edge_of_response<S: Simd>(u: f32x8<S>, kind: u32, epsilon: f32, phi: f32, faintness: f32) -> f32x8<S> {
    let edge = edge_threshold(u, kind, epsilon, phi);
    if kind == Threshold::None as u32 { edge } else { fainter(edge, faintness) }
}

/// The edge image where no covered pixel contributes: paper.
#[inline(always)]
pub fn edge_uncovered(kind: u32) -> f32 {
    if kind == Threshold::None as u32 { 0.0 } else { 1.0 }
}

/// The edge image of weighted sums of (u alpha, alpha); paper where no covered pixel contributes.
#[inline(always)]
pub fn edge_of_sums<S: Simd>(
    [sum, norm]: [f32x8<S>; 2],
    kind: u32,
    epsilon: f32,
    phi: f32,
    faintness: f32,
) -> f32x8<S> {
    let covered = norm.simd_gt(LEAST_COVERAGE);
    let u = sum / covered.select(norm, f32x8::splat(sum.simd, 1.0));
    let edge = edge_of_response(u, kind, epsilon, phi, faintness);
    covered.select(edge, f32x8::splat(sum.simd, edge_uncovered(kind)))
}

/// D = base G_sigma + edge (G_sigma - G_k sigma) (4.9) of two weighted sums of (L alpha, alpha), and where covered
/// pixels contribute to both. Dividing by the weighted coverage normalises the weights too.
#[inline(always)]
pub fn dog_of_sums<S: Simd>(
    [narrow, narrow_alpha]: [f32x8<S>; 2],
    [wide, wide_alpha]: [f32x8<S>; 2],
    base: f32,
    edge: f32,
) -> (f32x8<S>, mask32x8<S>) {
    let one = f32x8::splat(narrow.simd, 1.0);
    let covered = narrow_alpha.at_most(wide_alpha).simd_gt(LEAST_COVERAGE);
    let narrow = narrow / covered.select(narrow_alpha, one);
    let wide = wide / covered.select(wide_alpha, one);
    (narrow * base + (narrow - wide) * edge, covered)
}

#[cfg(test)]
mod tests {
    use super::*;
    use isophote_engine::fearless_simd::{Level, dispatch};

    fn at(kind: Threshold, u: f32) -> f32 {
        dispatch!(Level::new(), simd => edge_threshold(f32x8::splat(simd, u), kind as u32, 0.5, 2.0)[3])
    }

    #[test]
    fn curves_meet_at_epsilon_and_end_at_zero() {
        for kind in [Threshold::Tanh, Threshold::Smoothstep] {
            assert_eq!(at(kind, 0.5), 1.0);
            assert!((at(kind, 0.4999) - 1.0).abs() < 1e-3, "{kind:?}");
            assert!(at(kind, -1e6) < 1e-6 && at(kind, -1e6) >= 0.0, "{kind:?}");
            assert!(at(kind, 0.2) > at(kind, 0.1), "{kind:?}");
        }
        assert!((at(Threshold::Tanh, 0.0) - (1.0 - 1f32.tanh())).abs() < 1e-6);
        // 2 smoothstep(-2, 2, -1) = 2 (3/16 - 2/64).
        assert!((at(Threshold::Smoothstep, 0.0) - 0.3125).abs() < 1e-6);
        assert_eq!([at(Threshold::Binary, 0.49), at(Threshold::Binary, 0.5)], [0.0, 1.0]);
        assert_eq!(at(Threshold::None, -7.0), -7.0);
    }
}
