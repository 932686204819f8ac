//! Tones as an artist's marks (§ 4.3): hatching that bends over the form, crossed where it is dark, and strokes along and
//! across the form where the structure is significant (2.154). Marks of mean density d cover the share d of the paper, so
//! that tones stay in order. What is lighter than marks can say is rubbed in smoothly, and where nothing is dark the paper
//! stays bare. Lights of what is smeared are lifted out, as with a kneaded eraser.
//!
//! Strokes are averages of noise along stream lines. Beside the picture's border lines are cut and average less, which
//! raises their contrast; by how much is known for Gaussians, and taken back.
//!
//! Cost: 8 hashes, an eigenvector and about 190 multiply-adds per pixel.

pub use crate::kernels::shaders::tone_marks::Params;
use crate::kernels::shared::mark_tones::{INVERSE_FADE, SMOOTH_FROM, rise, tone_lightness};
use crate::kernels::shared::tensor;
use crate::kernels::shared::value_noise::noise;
use crate::kernels::simd::pixels::{Block, for_blocks, write};
use isophote_engine::dispatch::at_most_avx2;
use isophote_engine::fearless_simd::{Simd, dispatch, f32x8, prelude::*};
use isophote_engine::math::{self, Elementary};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(tone_marks {
    cpu: run,
    cost: |_| 490.0,
    tolerance: Tolerance {
        absolute: 3e-3,
        relative: 1e-3,
        outliers: 5e-3,
        reason: "crisp edges of strokes magnify the last bits of noise and of places, and a place beside the border \
                 of two hatches belongs to either",
    },
});

/// Rules by which tones become marks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tones {
    /// Lightness from which on nothing is dark, units of L.
    pub light: f32,
    /// Lightness from which down all is dark, below `light`.
    pub solid: f32,
    /// By how much middle tones are lighter than in proportion, 0..1.
    pub ease: f32,
    /// Share of the paper that the darkest marks cover, 0.7..=1.
    pub most: f32,
    /// Share of the tones that is rubbed in everywhere, 0..=1; the rest is hatched where it is not light.
    pub rubbed: f32,
    /// Share of the hatching that follows the form where that is significant, 0..=1.
    pub form: f32,
    /// Distance of hatches, pixels of the full-size picture.
    pub spacing: f32,
    /// Distance that they bend per unit of L of the relief, pixels of the full-size picture.
    pub bend: f32,
    /// Share of the tone that is lifted out where a place is lighter than the relief, 0..=1.
    pub lift: f32,
    /// Anisotropy from which on structure is significant.
    pub significant: f32,
    /// Width and length of strokes, standard deviations in pixels of the picture that is rendered.
    pub stroke: [f32; 2],
    /// Standard deviation of the strokes' values.
    pub deviation: f32,
    /// Standard deviation of the hatching's values, where it is given.
    pub given_deviation: f32,
    /// Rendered size over full size.
    pub scale: f32,
    /// Position of the picture in the canonical one, pixels.
    pub origin: [f32; 2],
}

/// Directions of hatches, of light and of deep tones, of length 1.
pub const HATCHING: [[f32; 2]; 2] = [[0.8, -0.6], [0.96, 0.28]];

/// Length of strokes across the form, in lengths of those along it.
pub const CROSSING: f32 = 0.6;

/// Softness of the edges of strokes, in values of 0..=1 at which they lie.
const SOFTNESS: f32 = 0.25;

/// Densities up to which the first of two directions has all strokes, and all hatches.
const FULL_STROKES: f32 = 0.5;
const FULL_HATCHES: f32 = 0.7;
/// Units of L above the relief from which on tone is lifted out, and the share of it per further unit.
const LIFT_FROM: f32 = 2.0;
const LIFT_SLOPE: f32 = 0.12;
/// Share of the paper that a given tone covers at least beyond the one before.
const LEAST_STEP: f32 = 0.01;

/// Images that tones are drawn after and with.
#[derive(Clone, Copy, Debug)]
pub struct Inputs {
    /// (L alpha, alpha), and the same of the relief ([`tone_relief`](super::tone_relief)).
    pub tones: ImageId,
    /// Tensor that strokes follow.
    pub tensor: ImageId,
    /// Noise, averaged along the stream lines of the tensor, in the first channel.
    pub strokes: ImageId,
    /// The same across them, shorter by [`CROSSING`].
    pub crossing: ImageId,
    /// Hatches that are not the pass' own.
    pub hatching: Hatching,
}

/// Hatches, and who draws them.
#[derive(Clone, Copy, Debug)]
pub enum Hatching {
    /// Straight ones that stay on the screen.
    Own,
    /// Noise along [`HATCHING`].
    Noise([ImageId; 2]),
    /// Ink of up to four tones ([`hatching_tones`](super::hatching_tones)), and the same smoothed; they say all tones.
    Tones([ImageId; 2]),
}

/// Adds the pass: the share of the paper that marks cover.
pub fn pass(plan: &mut PlanBuilder, inputs: &Inputs, tones: &Tones) -> ImageId {
    let [first, second] = match inputs.hatching {
        Hatching::Own => [inputs.strokes; 2],
        Hatching::Noise(images) | Hatching::Tones(images) => images,
    };
    let is_noise = matches!(inputs.hatching, Hatching::Noise(_));
    let params = Params {
        origin: tones.origin,
        inverse_scale: 1.0 / tones.scale,
        spacing: tones.spacing.max(0.5),
        light: tones.light,
        slope: 1.0 / (tones.light - tones.solid).max(1.0),
        ease: tones.ease.clamp(0.0, 0.99),
        smooth_from: SMOOTH_FROM,
        inverse_fade: INVERSE_FADE,
        rubbed: tones.rubbed.clamp(0.0, 1.0),
        form: tones.form.clamp(0.0, 1.0),
        significant: tones.significant,
        stroke_gain: 1.0 / tones.deviation.max(1e-3),
        stroke_width: tones.stroke[0].max(0.1),
        inverse_length: 1.0 / tones.stroke[1].max(0.1),
        softness: SOFTNESS,
        given_gain: if is_noise { 1.0 / tones.given_deviation.max(1e-3) } else { 0.0 },
        edge: edge(tones.scale),
        open: 1.0 - tones.most,
        bend: tones.bend,
        lift: tones.lift,
        drawn_tones: matches!(inputs.hatching, Hatching::Tones(_)).into(),
    };
    let images = [inputs.tones, inputs.tensor, inputs.strokes, inputs.crossing, first, second];
    plan.pass(&KERNEL, &images, &params, Class::Field, Support::Pixels(0))
}

/// Softness of the edges of strokes in pictures rendered at `scale` of their full size.
fn edge(scale: f32) -> f32 {
    // Values at which edges lie change by so much over a pixel of the full-size picture, which softness counts in already.
    const STEP: f32 = 0.1;
    let wider = (scale.powi(-2) - 1.0).max(0.0).sqrt();
    math::hypot(SOFTNESS, STEP * wider)
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    // Hashes of noise: by AVX-512 they take a third longer.
    dispatch!(at_most_avx2(pass.level), simd => for_blocks::<1>(band, #[inline(always)] |block, target| {
        let one = f32x8::splat(simd, 1.0);
        let [sum, alpha, around, cover]: [f32x8<_>; 4] = block.read(simd, &pass.inputs[0]);
        let lightness = tone_lightness([sum, alpha]);
        let ground = tone_lightness([around, cover]);
        let t = ((one * params.light - lightness) * params.slope).within(0.0, 1.0);
        let eased = t * (one - (one - t) * params.ease);
        let lifted = rise((lightness - ground - LIFT_FROM) * LIFT_SLOPE) * params.lift;
        let d = (eased - eased * eased * eased * params.open) * (one - lifted);
        let grained = rise((one * params.smooth_from - lightness) * params.inverse_fade);
        let marked = grained * (1.0 - params.rubbed);
        let mut density = d;
        if marked.simd_gt(0.0).any_true() {
            let drawn = if params.drawn_tones != 0 {
                given_tones(block.read(simd, &pass.inputs[4]), block.read(simd, &pass.inputs[5]), d)
            } else {
                drawn(simd, pass, &params, &block, [d, ground])
            };
            density = d + marked * (drawn - d);
        }
        write([density], target);
    }));
}

/// Density of the first of two directions that are to cover `d` together.
#[inline(always)]
fn shared_out<S: Simd>(d: f32x8<S>, full: f32) -> f32x8<S> {
    d - (d - full).at_least(0.0) * 0.5
}

/// Density that covers `d` together with `first`.
#[inline(always)]
fn remaining<S: Simd>(d: f32x8<S>, first: f32x8<S>) -> f32x8<S> {
    let one = f32x8::splat(d.simd, 1.0);
    one - (one - d) / (one - first).at_least(one * 1e-6)
}

/// A place in pixels of the full-size picture, from the paper's corner.
#[inline(always)]
fn on_paper<S: Simd>([x, y]: [f32x8<S>; 2], params: &Params) -> [f32x8<S>; 2] {
    [(x + params.origin[0]) * params.inverse_scale, (y + params.origin[1]) * params.inverse_scale]
}

/// Mask of the ink on the paper, for marks that cover the share `d` of it.
#[inline(always)]
fn drawn<S: Simd>(
    simd: S,
    pass: &CpuPass<'_>,
    params: &Params,
    block: &Block,
    [d, ground]: [f32x8<S>; 2],
) -> f32x8<S> {
    let one = f32x8::splat(simd, 1.0);
    let [e, f, g, _]: [f32x8<S>; 4] = block.read(simd, &pass.inputs[1]);
    let tangent = tensor::tangent(e, f, g);
    // By the change from pixel to pixel of the full-size picture, so that proxies show the same marks.
    let gradient = (e + g).at_least(0.0).sqrt() / params.inverse_scale;
    let form = rise((tensor::anisotropy(e, f, g) - params.significant) * 4.0)
        * rise((gradient - 0.003) * 180.0)
        * params.form;
    let [noise, ..]: [f32x8<S>; 4] = block.read(simd, &pass.inputs[2]);
    let place = block.centres(simd);
    let full = pass.inputs[1].full();
    let gain = border_gain(place, full, (tangent, params.inverse_length), params);
    let z = (noise - 0.5) * params.stroke_gain * gain;
    let [noise, ..]: [f32x8<S>; 4] = block.read(simd, &pass.inputs[3]);
    let crosswise = ([tangent[1], tangent[0]], params.inverse_length / CROSSING);
    let gain = border_gain(place, full, crosswise, params);
    let z_across = (noise - 0.5) * params.stroke_gain * gain;
    // What strokes along the form leave over of darks goes across it, and what both leave over is hatched.
    let followed = d * form;
    let long = shared_out(followed, FULL_STROKES);
    let crossed = remaining(followed, long);
    let rest = remaining(d, followed);
    let first = shared_out(rest, FULL_HATCHES);
    let second = remaining(rest, first);
    let mut means = [first, second];
    let hatches = if params.given_gain > 0.0 {
        means = [stroke_mean(first, params), stroke_mean(second, params)];
        let [a, ..]: [f32x8<S>; 4] = block.read(simd, &pass.inputs[4]);
        let [b, ..]: [f32x8<S>; 4] = block.read(simd, &pass.inputs[5]);
        let gain = params.given_gain;
        [stroke((a - 0.5) * gain, first, params), stroke((b - 0.5) * gain, second, params)]
    } else {
        let q = on_paper(place, params);
        let shift = (ground - 50.0) * params.bend;
        [
            hatch(simd, q, (HATCHING[0], shift), (first, 301), params),
            hatch(simd, q, (HATCHING[1], -shift), (second, 701), params),
        ]
    };
    let mut bare = (one - stroke(z, long, params))
        * (one - stroke(z_across, crossed, params))
        * (one - hatches[0])
        * (one - hatches[1]);
    if params.rubbed > 0.0 {
        // What strokes leave bare of light tones is rubbed in, or paper would glow where smooth tones end.
        let left = (one - stroke_mean(long, params))
            * (one - stroke_mean(crossed, params))
            * (one - means[0])
            * (one - means[1]);
        bare *= ((one - d) / left.at_least(one * 1e-6)).at_most(one);
    }
    one - bare
}

/// Hatching that covers the share `d` of the paper, by tones that cover `tones` of a pixel and `around` of what is around it.
/// Between two tones the darker one fades in; beyond the last all is solid.
#[inline(always)]
fn given_tones<S: Simd>(tones: [f32x8<S>; 4], around: [f32x8<S>; 4], d: f32x8<S>) -> f32x8<S> {
    let one = f32x8::splat(d.simd, 1.0);
    let (mut covered, mut mean) = (one * 0.0, one * 0.0);
    for i in 0..5 {
        let (mut tone, mut level) = (one, one);
        if i < 4 {
            (tone, level) = (tones[i], around[i]);
        }
        let step = level - mean;
        let is_darker = step.simd_gt(LEAST_STEP);
        let share = ((d - mean) / step.at_least(LEAST_STEP)).within(0.0, 1.0);
        covered = is_darker.select(covered + (tone - covered) * share, covered);
        mean = is_darker.select(level, mean);
    }
    covered
}

/// Share of a pixel that a band covers, `r` from whose middle it lies and whose half width is `s`, in pixels of the
/// full-size picture.
#[inline(always)]
fn covered<S: Simd>(r: f32x8<S>, s: f32x8<S>, params: &Params) -> f32x8<S> {
    let size = 1.0 / params.inverse_scale.min(0.5 * params.spacing);
    ((s - r) * size + 0.5).within(0.0, 1.0) - ((-s - r) * size + 0.5).within(0.0, 1.0)
}

/// Hatches of mean density `d` along `along`, `shift` aside, as if drawn by hand.
#[inline(always)]
fn hatch<S: Simd>(
    simd: S,
    [x, y]: [f32x8<S>; 2],
    (along, shift): ([f32; 2], f32x8<S>),
    (d, seed): (f32x8<S>, u32),
    params: &Params,
) -> f32x8<S> {
    let one = f32x8::splat(simd, 1.0);
    let spacing = params.spacing;
    let p = x * along[0] + y * along[1];
    let across = y * along[0] - x * along[1] + shift;
    let slow = 0.06 / spacing;
    let across = across + (noise(simd, p * slow, across * slow, seed) - 0.5) * (spacing * 0.45);
    let phase = across / spacing;
    let line = phase.floor();
    // The pressure of the hand, stroke by stroke.
    let pressure = noise(simd, p * (0.11 / spacing), line * 7.0, seed + 57) - 0.5;
    let density = (d + d * (one - d) * pressure * 0.7).within(0.0, 1.0);
    let r = (phase - line - 0.5).abs() * spacing;
    let half = one * (0.5 * spacing);
    let light = covered(r, density * half, params);
    let dark = one - covered(half - r, (one - density) * half, params);
    density.simd_le(0.5).select(light, dark)
}

/// Strokes of mean density `d` where noise is higher than most, `z` in standard deviations.
#[inline(always)]
fn stroke<S: Simd>(z: f32x8<S>, d: f32x8<S>, params: &Params) -> f32x8<S> {
    let h = (z * 0.8).within(-8.0, 8.0).tanh() * 0.5 + 0.5;
    let foot = d * (1.0 + params.softness);
    let wide = foot - 0.5 * params.softness;
    // What is nearly bare or nearly solid stays so.
    let room = foot.at_most(-foot + (1.0 + params.softness)).at_least(0.0);
    let edge = (room + params.softness).at_most(params.edge);
    ((wide - h) / edge + 0.5).within(0.0, 1.0)
}

/// The mean of strokes that are asked for a density: where they are thinner than their soft edges they cover less.
#[inline(always)]
fn stroke_mean<S: Simd>(d: f32x8<S>, params: &Params) -> f32x8<S> {
    let wide = d * (1.0 + params.softness);
    let thin = wide * wide * (0.5 / params.softness);
    wide.simd_lt(params.softness).select(thin, wide - 0.5 * params.softness)
}

/// By how much fewer grains a stroke averages beside the picture's border, where its line is cut: 1 over the root of the
/// variance that it gains. For a Gaussian cut at D standard deviations from its middle that variance grows by about
/// exp(-0.92 D - 0.28 D^2).
#[inline(always)]
fn border_gain<S: Simd>(
    place: [f32x8<S>; 2],
    full: [i32; 2],
    (tangent, inverse_length): ([f32x8<S>; 2], f32),
    params: &Params,
) -> f32x8<S> {
    let one = f32x8::splat(place[0].simd, 1.0);
    let mut variance = one;
    for i in 0..2 {
        let near = place[i].at_most(one * full[i] as f32 - place[i]);
        let cut = near * inverse_length / tangent[i].abs().at_least(1e-3);
        let beside = near / params.stroke_width;
        for d in [cut, beside] {
            variance *= one + (d * (d * -0.28 - 0.92)).at_least(-80.0).exp();
        }
    }
    one / variance.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use isophote_engine::fearless_simd::Level;

    const PARAMS: Params = Params {
        origin: [0.0; 2],
        inverse_scale: 1.0,
        spacing: 6.0,
        light: 68.0,
        slope: 0.02,
        ease: 0.0,
        smooth_from: SMOOTH_FROM,
        inverse_fade: INVERSE_FADE,
        rubbed: 0.0,
        form: 1.0,
        significant: 0.5,
        stroke_gain: 1.0,
        stroke_width: 1.0,
        inverse_length: 0.1,
        softness: SOFTNESS,
        given_gain: 0.0,
        edge: SOFTNESS,
        open: 0.0,
        bend: 0.0,
        lift: 0.0,
        drawn_tones: 0,
    };

    /// The mean of hatches of density `d` over a large field.
    fn mean(d: f32) -> f32 {
        dispatch!(Level::new(), simd => {
            let mut sum = 0.0;
            let columns = f32x8::simd_from(simd, std::array::from_fn::<f32, 8, _>(|i| i as f32));
            for y in 0..400 {
                for x in 0..50 {
                    let q = [columns + (x * 8) as f32 + 0.5, f32x8::splat(simd, y as f32 + 0.5)];
                    let ink = hatch(simd, q, (HATCHING[0], f32x8::splat(simd, 0.0)), (f32x8::splat(simd, d), 301), &PARAMS);
                    sum += <[f32; 8]>::from(ink).iter().sum::<f32>();
                }
            }
            sum / (400.0 * 400.0)
        })
    }

    #[test]
    fn hatches_cover_the_share_of_the_paper_that_they_are_asked_for() {
        for d in [0.0, 0.05, 0.2, 0.5, 0.7, 0.95, 1.0] {
            let found = mean(d);
            assert!((found - d).abs() < 0.025, "{d}: {found}");
        }
    }

    #[test]
    fn the_mean_of_strokes_is_known() {
        for d in [0.0, 0.05, 0.1, 0.2, 0.35, 0.5] {
            let (mut sum, mut weights, mut known) = (0.0, 0.0, 0.0);
            for step in -400..=400 {
                let z = step as f32 * 0.01;
                let weight = (-0.5 * z * z).exp();
                dispatch!(Level::new(), simd => {
                    let [z, d] = [z, d].map(|v| f32x8::splat(simd, v));
                    sum += weight * <[f32; 8]>::from(stroke(z, d, &PARAMS))[0];
                    known = <[f32; 8]>::from(stroke_mean(d, &PARAMS))[0];
                });
                weights += weight;
            }
            let found = sum / weights;
            assert!((found - known).abs() < 0.02, "{d}: {found} instead of {known}");
            assert!(known <= d, "{d}: {known}");
        }
    }
}
