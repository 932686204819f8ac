//! Thin paint on paper: pigment that gathers at the borders of dark regions, in clouds and in the grain
//! of the paper (Bousseau et al. 2006): C - (C - C^2) d with the density d above its mean. Clouds and
//! grain belong to the full-size picture, so that tiles and proxies show the same paper; clouds may be given, too.
//!
//! Cost: 16 hashes and about 150 multiply-adds.

pub use crate::kernels::shaders::watercolor_wash::Params;
use crate::kernels::shared::value_noise::noise;
use crate::kernels::simd::pixels::{for_blocks, write};
use isophote_engine::dispatch::at_most_avx2;
use isophote_engine::fearless_simd::{Simd, dispatch, f32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(watercolor_wash {
    cpu: run,
    cost: |_| 260.0,
    tolerance: Tolerance {
        absolute: 5e-5,
        relative: 1e-5,
        outliers: 1e-3,
        reason: "cells are placed by products exact to a few units in the last place",
    },
});

/// Appearance of paint on paper.
#[derive(Clone, Copy, Debug)]
pub struct Wash {
    /// Rendered size over full size.
    pub scale: f32,
    /// Amount of pigment: 1 leaves the colours alone, 0 only paper.
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
}

/// Clouds that stay on the screen, in two layers: cells per pixel of the full-size picture, share and seed.
pub const CLOUDS: [(f32, f32, u32); 2] = [(0.017, 0.6, 11), (0.043, 0.4, 503)];

/// Paints `color`; `blurred` is the same, smoothed by the width of the dark borders, and `clouds` are grey and of mean
/// 0.5 where they are not to be [`CLOUDS`].
pub fn pass(
    plan: &mut PlanBuilder,
    color: ImageId,
    blurred: ImageId,
    clouds: Option<ImageId>,
    wash: &Wash,
) -> ImageId {
    let params = Params {
        inverse_scale: 1.0 / wash.scale,
        pigment: wash.pigment,
        edges: wash.edges,
        clouds: wash.clouds,
        grain: wash.grain,
        grain_frequency: 1.0 / wash.grain_size.max(0.5),
        origin: wash.origin,
        given: clouds.is_some().into(),
        padding: Default::default(),
    };
    let inputs = [color, blurred, clouds.unwrap_or(color)];
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
                let [given, ..]: [f32x8<S>; 4] = block.read(simd, &pass.inputs[2]);
                given
            } else {
                let [(f, a, s), (g, b, t)] = CLOUDS;
                noise(simd, x * f, y * f, s) * a + noise(simd, x * g, y * g, t) * b
            };
            let (gx, gy) = (x * params.grain_frequency, y * params.grain_frequency);
            let grain = noise(simd, gx, gy, 1013) * 0.6 + noise(simd, gx * 2.3, gy * 2.3, 2027) * 0.4;
            let v: [f32x8<S>; 4] = block.read(simd, &pass.inputs[0]);
            let around: [f32x8<S>; 4] = block.read(simd, &pass.inputs[1]);
            let excess = luma(&around) - luma(&v);
            let gathered = (excess.at_least(0.0) + (-excess).at_least(0.0) * 0.25) * params.edges;
            let density = gathered + (cloud * 2.0 - 1.0) * params.clouds + (grain * 2.0 - 1.0) * params.grain;
            let painted = |c: f32x8<S>| {
                let thin = f32x8::splat(simd, 1.0) - (f32x8::splat(simd, 1.0) - c) * params.pigment;
                thin - density * (thin - thin * thin).at_least(0.0)
            };
            write([painted(v[0]), painted(v[1]), painted(v[2]), v[3]], target);
        },
    );
}

/// Luma within the range of paper.
#[inline(always)]
fn luma<S: Simd>(v: &[f32x8<S>; 4]) -> f32x8<S> {
    (v[0] * 0.2126 + v[1] * 0.7152 + v[2] * 0.0722).within(0.0, 1.0)
}
