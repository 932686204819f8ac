//! A tensor field as a colour (§ 2.6).
//!
//! Orientation: the angle of the tangent, doubled so that opposite directions are one, on a circle of
//! hues whose saturation is the anisotropy; horizontal edges are red, 120 degrees of double angle are
//! green, grey means no orientation.
//!
//! All else is grey. Anisotropies are shown as they are. Gradient magnitude and corner measures have no
//! upper end, so v is shown as v / (v + half), which never clips: middle grey is a gradient of 0.1 a
//! pixel, and for corners a measure of 0.05^2. Measures that are fourth powers of gradients, those of
//! Harris and Rohr, are shown by their roots. That of Harris has a sign: middle grey is 0, edges are
//! darker and corners lighter.
//!
//! Cost: about 30 operations.

use crate::declare::choice::Numbered;
pub use crate::kernels::shaders::tensor_display::Params;
use crate::kernels::shared::tensor;
use crate::kernels::simd::pixels::map_pixels;
use isophote_engine::fearless_simd::{Simd, dispatch, f32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(tensor_display {
    cpu: run,
    cost: |_| 30.0,
    tolerance: Tolerance {
        absolute: 1e-3,
        relative: 0.0,
        outliers: 0.005,
        reason: "a determinant keeps the last bits of its products, a root magnifies them where the \
                 anisotropy is near 1 or a corner measure near 0, and a place at the threshold of \
                 significance goes either way",
    },
});

crate::declare::choice::numbered! {
    /// Quantity to show.
    pub enum Show {
        /// Hue by the double angle of the tangent, saturation by anisotropy.
        Orientation = 0,
        /// Anisotropy (2.137).
        Anisotropy = 1,
        /// Anisotropy of the roots of the eigenvalues (2.138).
        AnisotropySqrt = 2,
        /// Squared anisotropy (2.139).
        AnisotropySquared = 3,
        /// Gradient magnitude, sqrt(lambda1).
        Magnitude = 4,
        /// Corner response (2.159).
        Harris = 5,
        /// det / tr (2.160).
        Foerstner = 6,
        /// lambda2 (2.161).
        TomasiKanade = 7,
        /// The determinant.
        Rohr = 8,
        /// Anisotropy where it is above what noise gives (2.154); 0 elsewhere.
        Significance = 9,
        /// The condition number (2.140) over itself plus 1, by its relation to the anisotropy (2.142).
        Condition = 10,
    }
}

/// Measure to show, and its numbers.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// The measure.
    pub show: Show,
    /// k of the Harris measure (2.159).
    pub k: f32,
    /// Anisotropy from which on a place is [`Significance`](Show::Significance), as [`least_significant`] gives it.
    pub threshold: f32,
}

/// Anisotropy that noise exceeds with probability `alpha` in windows worth `samples` (2.154).
///
/// A Gaussian window is worth 4 pi rho^2 of them (2.158).
pub fn least_significant(alpha: f32, samples: f32) -> f32 {
    // Tensors of one sample are all of anisotropy 1.
    let exponent = 2.0 / (f64::from(samples) - 1.0).max(1e-6);
    (1.0 - f64::from(alpha).powf(exponent)).sqrt() as f32
}

/// Adds the pass: tensor to opaque colour.
pub fn pass(plan: &mut PlanBuilder, tensor: ImageId, options: &Options) -> ImageId {
    let Options { show, k, threshold } = *options;
    let params = Params { show: show.number(), k, threshold };
    plan.pass(&KERNEL, &[tensor], &params, Class::Colour, Support::Pixels(0))
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    let show = Show::of(params.show);
    dispatch!(pass.level, simd => map_pixels(simd, pass, band, #[inline(always)] |[e, f, g, _]| {
        let [r, g, b] = match show {
            Show::Orientation => orientation(simd, e, f, g),
            grey => [measure(simd, grey, &params, [e, f, g]); 3],
        };
        [r, g, b, f32x8::splat(simd, 1.0)]
    }));
}

#[inline(always)]
fn orientation<S: Simd>(simd: S, e: f32x8<S>, f: f32x8<S>, g: f32x8<S>) -> [f32x8<S>; 3] {
    let c = |v: f32| f32x8::splat(simd, v);
    // Anisotropy times (cos 2 phi, sin 2 phi), phi the angle of the tangent.
    let trace = (e + g).at_least(c(f32::MIN_POSITIVE));
    let (x, y) = ((g - e) / trace, f * -2.0 / trace);
    let (across, up) = (x * 0.25, y * 0.433_012_7);
    [x * 0.5 + 0.5, c(0.5) - across + up, c(0.5) - across - up]
}

/// Values that are shown as middle grey: a gradient and, for corners, a squared one.
const HALF_GRADIENT: f32 = 0.1;
const HALF_SQUARE: f32 = 0.0025;

/// Measure that is shown as a grey; of orientation, its anisotropy.
#[inline(always)]
fn measure<S: Simd>(simd: S, show: Show, params: &Params, t: [f32x8<S>; 3]) -> f32x8<S> {
    let c = |v: f32| f32x8::splat(simd, v);
    let a = tensor::anisotropy(t[0], t[1], t[2]);
    let Corner { trace, lambda1, determinant } = Corner::of(simd, t);
    match show {
        Show::Orientation | Show::Anisotropy => a,
        Show::AnisotropySqrt => a / (c(1.0) + (c(1.0) - a * a).at_least(c(0.0)).sqrt()),
        Show::AnisotropySquared => a * a,
        Show::Condition => a * 0.5 + 0.5,
        Show::Significance => a.simd_gt(c(params.threshold)).select(a, c(0.0)),
        Show::Magnitude => {
            let gradient = lambda1.at_least(c(0.0)).sqrt();
            gradient / (gradient + HALF_GRADIENT)
        }
        Show::Harris => {
            let harris = determinant - trace * params.k * trace;
            let grey = half_at_square(harris.abs().sqrt()) * 0.5;
            harris.simd_lt(c(0.0)).select(-grey, grey) + 0.5
        }
        Show::Foerstner => half_at_square(determinant / trace.at_least(c(f32::MIN_POSITIVE))),
        Show::TomasiKanade => half_at_square(determinant / lambda1.at_least(c(f32::MIN_POSITIVE))),
        Show::Rohr => half_at_square(determinant.sqrt()),
    }
}

#[inline(always)]
fn half_at_square<S: Simd>(square: f32x8<S>) -> f32x8<S> {
    square / (square + HALF_SQUARE)
}

/// Parts that measures of corners are made of.
struct Corner<S: Simd> {
    trace: f32x8<S>,
    lambda1: f32x8<S>,
    determinant: f32x8<S>,
}

impl<S: Simd> Corner<S> {
    #[inline(always)]
    fn of(simd: S, mut t: [f32x8<S>; 3]) -> Self {
        let c = |v: f32| f32x8::splat(simd, v);
        // Products of four gradients must not overflow.
        for v in &mut t {
            *v = v.within(c(-1e9), c(1e9));
        }
        let [e, f, g] = t;
        let trace = e + g;
        let lambda1 = trace * 0.5 + tensor::axis((e - g) * 0.5, f).0;
        // What rounding leaves of the determinant of a tensor of rank one is no corner.
        let determinant = (e * g - f * f - trace * 1e-6 * trace).at_least(c(0.0));
        Self { trace, lambda1, determinant }
    }
}
