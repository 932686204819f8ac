//! Noise that is carried along motion: that of the screen where each of two layers was anchored, faded into one another.
//!
//! The layers take turns (after Max and Becker, Flow visualization using moving textures, 1995): each begins anew, at the
//! pixel itself, when its share is 0. Where nothing moves both show a common noise at one place, and nothing changes. Where
//! things move they show it at two places: what fades out at the one and in at the other would seem to slide as if it were
//! on the screen, so that there each layer shows a noise of its own. With the part c of the common noise and the distance d
//! of the two places the layers' correlation is c^2 exp(-d^2 / (4 sigma^2)), and the sum is divided by its standard
//! deviation, so that nothing pulsates.
//!
//! Cost: 64 taps of a sharp interpolation and about 200 operations.

pub use crate::kernels::shaders::carried_noise::Params;
use crate::kernels::shared::motion::sample_sharp_covered4;
use crate::kernels::simd::pixels::Block;
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::math::Elementary;
use isophote_engine::{Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance, View};

crate::kernel!(carried_noise {
    block: |simd, pass, params| |block| faded(simd, pass, block, &params),
    cost: |_| 800.0,
    tolerance: Tolerance {
        absolute: 1e-3,
        relative: 0.0,
        outliers: 1e-3,
        reason: "the rounding of a position times the contrast between neighbours",
    },
});

/// Two layers that make one noise.
#[derive(Clone, Copy, Debug)]
pub struct Layers {
    /// Share of the second layer, 0..=1.
    pub share: f32,
    /// Standard deviation of the smoothing of the noise, pixels.
    pub sigma: f32,
    /// Farthest on each axis that marks are carried, pixels.
    pub farthest: f32,
}

/// Grey noise of the screen, what both layers have in common and what each has of its own, carried along the two ways of
/// `chain` ([`mark_chain`](super::mark_chain)).
pub fn pass(
    plan: &mut PlanBuilder,
    [common, first, second]: [ImageId; 3],
    chain: ImageId,
    layers: &Layers,
) -> ImageId {
    let sigma = layers.sigma.max(0.3);
    let params =
        Params { share: layers.share, falloff: -0.25 / (sigma * sigma), decay: 1.0 / (APART * sigma) };
    let around = Support::Pixels(layers.farthest.ceil() as u32 + 3);
    let supports = [around, around, around, Support::Pixels(0)];
    plan.pass_reaching(&KERNEL, &[common, first, second, chain], &params, &[Class::Colour], &supports, 0)
}

/// Distance of places, in standard deviations of the smoothing of the noise, from which on the layers have nothing in
/// common.
const APART: f32 = 0.5;

#[inline(always)]
fn faded<S: Simd>(simd: S, pass: &CpuPass<'_>, block: Block, params: &Params) -> [f32x8<S>; 4] {
    let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
    let [common, first, second, chain] = pass.inputs else { return [zero; 4] };
    let ways: [f32x8<S>; 4] = block.read(simd, chain);
    let [x, y] = block.centres(simd);
    let (px, py, qx, qy) = (x + ways[0], y + ways[1], x + ways[2], y + ways[3]);
    let (dx, dy) = (ways[2] - ways[0], ways[3] - ways[1]);
    let apart = dx * dx + dy * dy;
    let t = (apart.sqrt() * params.decay).at_most(one);
    let shared = one - t * t * (t * -2.0 + 3.0);
    let own = (one - shared * shared).at_least(zero).sqrt();
    let at_first = shared * noise_at(simd, common, px, py) + own * noise_at(simd, first, px, py);
    let at_second = shared * noise_at(simd, common, qx, qy) + own * noise_at(simd, second, qx, qy);
    // The common noise is like itself at both places as far as these are near: the variance of the sum is known.
    let alike = shared * shared * (apart * params.falloff).at_least(-80.0).exp();
    let (a, b) = (1.0 - params.share, params.share);
    let variance = alike * (2.0 * a * b) + (a * a + b * b);
    let value = ((at_first * a + at_second * b) / variance.sqrt() + 0.5).within(zero, one);
    [value, value, value, one]
}

/// A place along an axis of so many pixels; beyond its ends it is mirrored.
#[inline(always)]
fn mirrored<S: Simd>(p: f32x8<S>, full: i32) -> f32x8<S> {
    let full = f32x8::splat(p.simd, full as f32);
    full - (full - p.abs()).abs()
}

/// The noise at places; beyond the border it is mirrored.
#[inline(always)]
fn noise_at<S: Simd>(simd: S, view: &View<'_>, x: f32x8<S>, y: f32x8<S>) -> f32x8<S> {
    let [w, h] = view.full();
    sample_sharp_covered4(simd, view, mirrored(x, w), mirrored(y, h))[0] - 0.5
}
