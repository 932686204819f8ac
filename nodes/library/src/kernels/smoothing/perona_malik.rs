//! One explicit step of Perona and Malik's diffusion (3.3) towards the four neighbours. The
//! diffusivity (3.2) is that of the difference to the neighbour, as Euclidean distance of the three
//! colour channels; neighbours count by their coverage.
//!
//! Diffusivities are at most 1, so for time steps up to 1/4 every step is a weighted mean: stable, and
//! no value leaves the range of its neighbourhood.
//!
//! Cost: 60 operations (exponential: 100); memory takes longer.

use crate::declare::choice::Numbered;
pub use crate::kernels::shaders::perona_malik::Params;
use crate::kernels::simd::line_buffer::{Row, WIDE_STRIP, for_rows, pixels};
use crate::kernels::simd::pixels::{BLOCK, write};
use isophote_engine::fearless_simd::{Simd, dispatch, f32x8, prelude::*};
use isophote_engine::math::Elementary;
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(perona_malik {
    cpu: run,
    cost: |p| if p.diffusivity == Diffusivity::Exponential as u32 { 100.0 } else { 60.0 },
    tolerance: Tolerance::of_rounding(1e-6, 2e-6, "a weighted mean of five pixels"),
});

crate::declare::choice::choice! {
    /// The diffusivity g (3.2).
    pub enum Diffusivity {
        /// Keeps wide areas.
        Rational = 0 ("rational", "Wide areas"),
        /// Keeps edges of high contrast.
        Exponential = 1 ("exponential", "Strong edges"),
    }
}

/// Options of a step.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Length of the step.
    pub time_step: f32,
    /// K or lambda, in the unit of the colour.
    pub contrast: f32,
    /// The diffusivity.
    pub diffusivity: Diffusivity,
}

/// A step of the diffusion.
pub fn pass(plan: &mut PlanBuilder, color: ImageId, options: &Options) -> ImageId {
    let Options { time_step, contrast, diffusivity } = *options;
    let falloff = 1.0 / (contrast * contrast).max(1e-12);
    let params = Params { time_step, falloff, diffusivity: diffusivity.number() };
    plan.pass(&KERNEL, &[color], &params, Class::Colour, Support::Pixels(1))
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    match Diffusivity::of(params.diffusivity) {
        Diffusivity::Rational => {
            dispatch!(pass.level, simd => diffused::<_, false>(simd, pass, &params, band));
        }
        Diffusivity::Exponential => {
            dispatch!(pass.level, simd => diffused::<_, true>(simd, pass, &params, band));
        }
    }
}

#[inline(always)]
fn diffused<S: Simd, const EXPONENTIAL: bool>(
    simd: S,
    pass: &CpuPass<'_>,
    params: &Params,
    band: &mut Band<'_>,
) {
    for_rows::<S, 4>(
        simd,
        &pass.inputs[0],
        band,
        [WIDE_STRIP, 1],
        std::convert::identity,
        #[inline(always)]
        |Row { buffer, y, .. }, target| {
            let (above, centre, below) = (buffer.channels(y - 1), buffer.channels(y), buffer.channels(y + 1));
            for (i, target) in target.chunks_mut(4 * BLOCK).enumerate() {
                let at = BLOCK * i + 1;
                let origin = pixels(simd, &centre, at);
                let neighbours = [
                    pixels(simd, &centre, at - 1),
                    pixels(simd, &centre, at + 1),
                    pixels(simd, &above, at),
                    pixels(simd, &below, at),
                ];
                write(block::<S, EXPONENTIAL>(simd, &origin, &neighbours, params), target);
            }
        },
    );
}

#[inline(always)]
fn block<S: Simd, const EXPONENTIAL: bool>(
    simd: S,
    origin: &[f32x8<S>; 4],
    neighbours: &[[f32x8<S>; 4]; 4],
    params: &Params,
) -> [f32x8<S>; 4] {
    let zero = f32x8::splat(simd, 0.0);
    let one = f32x8::splat(simd, 1.0);
    let falloff = f32x8::splat(simd, params.falloff);
    let mut sum = [zero; 3];
    for v in neighbours {
        let d = [v[0] - origin[0], v[1] - origin[1], v[2] - origin[2]];
        let s = d[2].mul_add(d[2], d[1].mul_add(d[1], d[0] * d[0])) * falloff;
        let g = if EXPONENTIAL { (-s.at_most(f32x8::splat(simd, 87.0))).exp() } else { one / (one + s) };
        let g = g * v[3];
        for c in 0..3 {
            sum[c] = g.mul_add(d[c], sum[c]);
        }
    }
    let time_step = f32x8::splat(simd, params.time_step);
    [
        time_step.mul_add(sum[0], origin[0]),
        time_step.mul_add(sum[1], origin[1]),
        time_step.mul_add(sum[2], origin[2]),
        origin[3],
    ]
}
