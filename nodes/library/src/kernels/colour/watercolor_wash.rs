//! Transparent paint on white paper: pigment has a density, which grows at the borders of dark regions, in clouds, in the
//! grain of the paper and where water has pushed it to a rim (Bousseau et al. 2006). Wet places bleed; dry ones leave gaps
//! beside dark shapes and bare peaks of the grain (Montesdeoca et al. 2017). Paint of density 1 + d lets C / (1 + d (1 - C))
//! through, which has the slope of C^(1 + d) at white paper and stays positive. Clouds and grain belong to the
//! full-size picture, so that tiles and proxies show the same paper; clouds and paper may be given, too.
//!
//! Cost: 16 hashes and about 250 multiply-adds.

pub use crate::kernels::shaders::watercolor_wash::Params;
use crate::kernels::shared::value_noise::noise;
use crate::kernels::simd::pixels::{for_blocks, write};
use isophote_engine::dispatch::at_most_avx2;
use isophote_engine::fearless_simd::{Simd, dispatch, f32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(watercolor_wash {
    cpu: run,
    cost: |_| 360.0,
    tolerance: Tolerance {
        absolute: 4e-4,
        relative: 1e-5,
        outliers: 1e-3,
        reason: "cells are placed by products exact to a few units in the last place, and steps at borders of \
                 bare paper magnify that",
    },
});

/// Appearance of paint on paper.
#[derive(Clone, Copy, Debug)]
pub struct Wash {
    /// Rendered size over full size.
    pub scale: f32,
    /// Share of the paper that the darkest paint covers: 0 is only paper.
    pub pigment: f32,
    /// Density gained per unit of luma by which the blurred picture is lighter.
    pub edges: f32,
    /// Density gained and lost in clouds.
    pub clouds: f32,
    /// Density gained and lost in the paper's grain.
    pub grain: f32,
    /// Size of the grain in pixels of the full-size picture.
    pub grain_size: f32,
    /// Position of the picture in the canonical one, pixels.
    pub origin: [f32; 2],
    /// Paper in the lights: square of the darkness of which paint covers half, against the light that is left.
    pub white: f32,
    /// Share of the colours around that wet places take.
    pub bleeding: f32,
    /// Share of the paint that is missing beside dark shapes.
    pub gaps: f32,
    /// Share of the paint that peaks of the grain do not take where the brush is dry.
    pub dry: f32,
    /// Density at the rim of water that ran back.
    pub backruns: f32,
}

/// Clouds that stay on the screen, in two layers: cells per pixel of the full-size picture, share and seed.
pub const CLOUDS: [(f32, f32, u32); 2] = [(0.009, 0.62, 11), (0.025, 0.38, 503)];

/// Depth of a given grain against that of the paper's own, whose pits and peaks are as deep.
const EVEN: f32 = 0.65;

/// The picture that is painted: itself, smoothed by the width of the dark borders, and smoothed as far as it bleeds.
#[derive(Clone, Copy, Debug)]
pub struct Drawn {
    /// Colours.
    pub color: ImageId,
    /// The same, smoothed by the width of the dark borders.
    pub blurred: ImageId,
    /// The same, smoothed as far as paint bleeds.
    pub wide: ImageId,
    /// Grey ones of mean 0.5 where clouds are not to be [`CLOUDS`].
    pub clouds: Option<ImageId>,
    /// Colours of a paper, and the depth of its grain ([`paper_relief`](super::paper_relief)).
    pub paper: Option<ImageId>,
}

/// Paints `drawn`.
pub fn pass(plan: &mut PlanBuilder, drawn: &Drawn, wash: &Wash) -> ImageId {
    let params = Params {
        inverse_scale: 1.0 / wash.scale,
        pigment: wash.pigment,
        edges: wash.edges,
        clouds: wash.clouds,
        grain: wash.grain,
        grain_frequency: 1.0 / wash.grain_size.max(0.5),
        origin: wash.origin,
        given: drawn.clouds.is_some().into(),
        papered: drawn.paper.is_some().into(),
        white: wash.white,
        bleeding: wash.bleeding,
        gaps: wash.gaps,
        dry: wash.dry,
        backruns: wash.backruns,
        padding: Default::default(),
    };
    let [clouds, paper] = [drawn.clouds, drawn.paper].map(|given| given.unwrap_or(drawn.color));
    let inputs = [drawn.color, drawn.blurred, drawn.wide, clouds, paper];
    plan.pass(&KERNEL, &inputs, &params, Class::Colour, Support::Pixels(0))
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    // By AVX-512 it takes a third longer.
    dispatch!(at_most_avx2(pass.level), simd => washed(simd, pass, &params, band));
}

#[inline(always)]
fn washed<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, band: &mut Band<'_>) {
    for_blocks::<4>(
        band,
        #[inline(always)]
        |block, target| {
            let columns: f32x8<S> = block.columns(simd).to_float();
            let x = (columns + 0.5 + params.origin[0]) * params.inverse_scale;
            let y = f32x8::splat(simd, (block.y as f32 + 0.5 + params.origin[1]) * params.inverse_scale);
            let cloud = if params.given != 0 {
                let [given, ..]: [f32x8<S>; 4] = block.read(simd, &pass.inputs[3]);
                given
            } else {
                let [(f, a, s), (g, b, t)] = CLOUDS;
                noise(simd, x * f, y * f, s) * a + noise(simd, x * g, y * g, t) * b
            };
            let (paper, grain) = if params.papered != 0 {
                let [r, g, b, depth] = block.read(simd, &pass.inputs[4]);
                ([r, g, b], (depth - 0.5) * EVEN + 0.5)
            } else {
                let (gx, gy) = (x * params.grain_frequency, y * params.grain_frequency);
                let grain = noise(simd, gx, gy, 1013) * 0.6 + noise(simd, gx * 2.3, gy * 2.3, 2027) * 0.4;
                ([f32x8::splat(simd, 1.0); 3], grain)
            };
            let [color, blurred, wide] = [0, 1, 2].map(
                #[inline(always)]
                |i| -> [f32x8<S>; 4] { block.read(simd, &pass.inputs[i]) },
            );
            let [r, g, b, a] = painted(params, [cloud, grain], color, luma(&blurred), &wide);
            write([r * paper[0], g * paper[1], b * paper[2], a], target);
        },
    );
}

/// Paint of a colour where the water and the paper are those of `cloud` and `grain`.
#[inline(always)]
fn painted<S: Simd>(
    params: &Params,
    [cloud, grain]: [f32x8<S>; 2],
    v: [f32x8<S>; 4],
    blurred: f32x8<S>,
    wide: &[f32x8<S>; 4],
) -> [f32x8<S>; 4] {
    let one = f32x8::splat(cloud.simd, 1.0);
    // Detail counts against the light that is there.
    let (tone, around) = (luma(&v), luma(wide));
    let detail = (around - tone).abs() / (around + 0.25);
    let calm = one - rise(detail, 0.015, 22.0);
    let wet = rise(cloud, 0.46, 6.0) * params.bleeding * (one - rise(detail, 0.04, 12.5));
    let bled = |c: usize| v[c] + wet * (wide[c] - v[c]);
    let color = [bled(0), bled(1), bled(2), v[3]];

    // Bare paper: in lights, at dark shapes where the brush was dry, and on peaks of the grain.
    let excess = blurred - tone;
    let darkness = one - luma(&color);
    let dryness = one - rise(cloud, 0.42, 6.0);
    let gap = dryness * params.gaps * rise(-excess, 0.035, 18.0) * rise(grain, 0.25, 4.0);
    let peak = rise(grain + (cloud * -1.0 + 0.36) * 0.6, 0.7, 10.0) * params.dry;
    let bare = peak * calm * rise(darkness, 0.03, 14.0) * (one - rise(darkness, 0.35, 3.3));
    let (dark, left) = (darkness * darkness, one - darkness);
    let light = left * left * params.white;
    let covered = dark / (dark + light).at_least(1e-6) * (one - gap) * (one - bare);

    // Density above that of the plain colour; thin paint cannot lose more than it has.
    let gathered = excess.within(0.0, 0.1) + (-excess).within(0.0, 0.12) * 0.05;
    let gathered = gathered * params.edges * (wet * -0.8 + 1.0);
    let rim = (cloud - 0.66) * 20.0;
    let outside = (-rim).at_least(0.0);
    let pushed = (outside * outside * -0.5 + 1.0).at_least(0.0) * 0.5;
    let water = rise(rim, -0.2, 1.4);
    let thinned = water * (rise(rim, 0.5, 0.28) * -0.8 + 1.0);
    let backrun = calm * params.backruns * (pushed * (one - water) - thinned);
    let uneven = (cloud * 2.0 - 1.0) * params.clouds + (grain * 2.0 - 1.0) * params.grain;
    let density = (gathered + backrun + uneven + 0.55).at_least(-0.7);

    // What is brighter than paper stays.
    let mut seen = v;
    for channel in 0..3 {
        let absorbed = one - color[channel];
        let paint = one - covered * absorbed.at_least(0.0);
        let dense = paint / (density * (one - paint).within(0.0, 1.0) + 1.0);
        seen[channel] = one - (one - dense) * params.pigment - absorbed.at_most(0.0);
    }
    seen
}

/// A smooth step from 0 at `start` to 1 at start + 1 / `inverse`.
#[inline(always)]
fn rise<S: Simd>(v: f32x8<S>, start: f32, inverse: f32) -> f32x8<S> {
    let t = ((v - start) * inverse).within(0.0, 1.0);
    t * t * (t * -2.0 + 3.0)
}

/// Luma within the range of paper.
#[inline(always)]
fn luma<S: Simd>(v: &[f32x8<S>; 4]) -> f32x8<S> {
    (v[0] * 0.2126 + v[1] * 0.7152 + v[2] * 0.0722).within(0.0, 1.0)
}
