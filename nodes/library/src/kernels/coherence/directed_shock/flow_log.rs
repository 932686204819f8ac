//! The flow-based Laplacian of Gaussian (§ 6.4.3, Listing 6.1): the scale-normalised second derivative
//! of a Gaussian of the luma along the major eigenvector, negative about maxima and positive about
//! minima. Taps are one pixel apart on the nearer axis; their sum is multiplied by the step, so that
//! diagonals respond alike.
//!
//! The weights sum to zero, as those of a derivative should: taps count as differences to the centre.
//! As far as a tap is transparent it stands for the centre. Twin of `flow_log` in shaders/coherence/directed_shock.wgsl.
//!
//! Cost: 5 sigma steps, each one linear interpolation between sums of opposite pixels and about 20 operations.

use super::luma_taps::{Line, LumaTaps};
use crate::kernels::simd::pixels::Block;
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::math::Elementary;

/// Distance of the last tap in standard deviations (Listing 6.1).
pub const CUTOFF: f32 = 5.0;

/// Most taps to a side, when the last one lies `reach` pixels away.
pub fn radius(reach: f32) -> i32 {
    (reach + 1e-3) as i32
}

/// The response of eight pixels to a Gaussian of standard deviation `sigma`, whose last tap lies `reach` pixels
/// away, in the unit of luma; `lumas` are weighted by coverage, and `line` leads through them.
#[inline(always)]
pub fn response<S: Simd, const OPAQUE: bool>(
    simd: S,
    [sigma, reach]: [f32; 2],
    lumas: &LumaTaps,
    line: &Line<S>,
    block: Block,
) -> f32x8<S> {
    let step = f32x8::splat(simd, 1.0) / line.major_share;
    let steps = (line.major_share * (reach + 1e-3)).floor();
    let mut centre = lumas.centre(simd, block.x, block.y);
    if !OPAQUE {
        let alpha = lumas.coverage(simd, block.x, block.y);
        let seen = alpha.simd_gt(f32x8::splat(simd, 1e-6));
        centre = seen.select(centre / alpha, f32x8::splat(simd, 0.0));
    }
    let variance = sigma * sigma;
    // exp(-d^2 / 2 sigma^2) at d = k step, from one step to the next.
    let falloff = (step * step * (-0.721_347_52 / variance)).exp2();
    let taps = Taps { lumas, line, step, steps, centre, variance, falloff, radius: radius(reach) };
    let sum = match line.rows() {
        1 => taps.sum::<OPAQUE, 1>(simd),
        2 => taps.sum::<OPAQUE, 2>(simd),
        3 => taps.sum::<OPAQUE, 3>(simd),
        _ => taps.sum::<OPAQUE, 0>(simd),
    };
    sum * step / (2.506_628_3 * variance * sigma)
}

/// Taps of eight pixels.
struct Taps<'a, S: Simd> {
    lumas: &'a LumaTaps,
    line: &'a Line<S>,
    /// Pixels from tap to tap.
    step: f32x8<S>,
    /// Taps to a side.
    steps: f32x8<S>,
    centre: f32x8<S>,
    variance: f32,
    /// exp(-step^2 / 2 sigma^2).
    falloff: f32x8<S>,
    /// Most taps to a side.
    radius: i32,
}

impl<S: Simd> Taps<'_, S> {
    /// Their weighted sum; `ROWS` is how the line is read.
    #[inline(always)]
    fn sum<const OPAQUE: bool, const ROWS: usize>(&self, simd: S) -> f32x8<S> {
        let Self { lumas, line, step, steps, centre, variance, falloff, radius } = *self;
        // The Gaussian is carried from one step to the next.
        let (mut gaussian, mut ratio) = (falloff, falloff * falloff * falloff);
        let mut sum = f32x8::splat(simd, 0.0);
        for k in 1..=radius {
            let active = steps.simd_ge(f32x8::splat(simd, k as f32));
            if !active.any_true() {
                break;
            }
            let d = step * k as f32;
            let across = line.slope * k as f32;
            // Opposite taps lie alike between their neighbours.
            let i = across.floor();
            let share = across - i;
            let [a, b] = lumas.opposite_pairs::<_, ROWS>(simd, line, k, i.to_int());
            let taps = (b - a).mul_add(share, a);
            let mut coverage = f32x8::splat(simd, 2.0);
            if !OPAQUE {
                let [a, b] = lumas.opposite_coverage::<_, ROWS>(simd, line, k, i.to_int());
                coverage = (b - a).mul_add(share, a);
            }
            let both = taps - coverage * centre;
            let weight = active.select((d * d - variance) * gaussian, f32x8::splat(simd, 0.0));
            sum = weight.mul_add(both, sum);
            gaussian *= ratio;
            ratio *= falloff * falloff;
        }
        sum
    }
}
