//! Smooth noise of the screen, of two layers: clouds of pigment, 0..=1. Cells are those of the full-size picture, so that
//! tiles and proxies show the same. Grey and opaque.
//!
//! Cost: eight hashes and about 60 multiply-adds.

pub use crate::kernels::shaders::smooth_noise::Params;
use crate::kernels::shared::value_noise;
use crate::kernels::simd::pixels::{for_blocks, write};
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Band, Class, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(smooth_noise {
    cpu: |simd, pass, params, band| clouded(simd, &params, band),
    cost: |_| 130.0,
    tolerance: Tolerance {
        absolute: 5e-5,
        relative: 1e-5,
        outliers: 1e-3,
        reason: "cells are placed by products exact to a few units in the last place",
    },
});

/// Cells per pixel of the full-size picture, share and seed of a layer.
pub type Layer = (f32, f32, u32);

/// Adds the pass: the sum of two layers, for a picture rendered at `scale` of its full size, which stands at `origin`,
/// pixels of that size, in the canonical one.
pub fn pass(plan: &mut PlanBuilder, layers: [Layer; 2], scale: f32, origin: [f32; 2]) -> ImageId {
    let params = Params {
        frequencies: layers.map(|layer| layer.0),
        shares: layers.map(|layer| layer.1),
        seeds: layers.map(|layer| layer.2),
        origin,
        inverse_scale: 1.0 / scale,
        padding: Default::default(),
    };
    plan.pass_at(&KERNEL, &[], &params, &[Class::Colour], Support::Pixels(0), 0)
}

#[inline(always)]
fn clouded<S: Simd>(simd: S, params: &Params, band: &mut Band<'_>) {
    let one = f32x8::splat(simd, 1.0);
    for_blocks::<4>(
        band,
        #[inline(always)]
        |block, target| {
            let [x, y] = block.centres(simd);
            let x = (x + params.origin[0]) * params.inverse_scale;
            let y = (y + params.origin[1]) * params.inverse_scale;
            let mut sum = f32x8::splat(simd, 0.0);
            for layer in 0..2 {
                let frequency = params.frequencies[layer];
                let value = value_noise::noise(simd, x * frequency, y * frequency, params.seeds[layer]);
                sum += value * params.shares[layer];
            }
            write([sum, sum, sum, one], target);
        },
    );
}
