//! Smooths noise along straight lines of one direction, which makes hatching of it, and stretches its contrast about
//! middle grey. Grey and opaque.
//!
//! The direction is that of the whole picture: a sample lies between the same four pixels everywhere, so that rows are
//! read as they lie in memory.
//!
//! Cost: four loads and multiply-adds per step.

pub use crate::kernels::shaders::line_blur::Params;
use crate::kernels::simd::pixels::{for_blocks, pixels_beside, write};
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(line_blur {
    cpu: |simd, pass, params, band| hatched(simd, pass, &params, band),
    cost: |p| f64::from(2 * p.count + 1) * 30.0,
    tolerance: Tolerance::of_rounding(1e-4, 0.0, "a mean of some dozens of values up to 1, times the gain"),
});

/// Lines that noise is smoothed along.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lines {
    /// Their direction, of length 1.
    pub direction: [f32; 2],
    /// From sample to sample, pixels.
    pub step: f32,
    /// Standard deviation of the Gaussian along them, pixels.
    pub sigma: f32,
    /// Factor on the contrast.
    pub gain: f32,
}

/// Smooths the first channel of `noise`.
pub fn pass(plan: &mut PlanBuilder, noise: ImageId, lines: &Lines) -> ImageId {
    let sigma = (lines.sigma / lines.step).max(0.1);
    let params = Params {
        step: lines.direction.map(|d| d * lines.step),
        count: (2.5 * sigma).ceil().min(64.0) as i32,
        falloff: -0.5 / (sigma * sigma),
        gain: lines.gain,
        padding: Default::default(),
    };
    plan.pass(&KERNEL, &[noise], &params, Class::Colour, Support::Pixels(reach(&params)))
}

/// The most pixels that a sample reads away.
fn reach(params: &Params) -> u32 {
    let [x, y] = params.step.map(|s| (s.abs() * params.count as f32).ceil() as u32 + 1);
    x.max(y)
}

/// Offset of a sample from a pixel, the shares of the four pixels around it, and its weight.
struct Sample {
    at: [i32; 2],
    shares: [f32; 4],
}

fn samples(params: &Params) -> (Vec<Sample>, f32) {
    let mut weights = 0.0;
    let mut samples = Vec::with_capacity(2 * params.count as usize + 1);
    for k in -params.count..=params.count {
        let weight = (params.falloff * (k * k) as f32).exp();
        let [x, y] = params.step.map(|s| s * k as f32);
        let (fx, fy) = (x - x.floor(), y - y.floor());
        let shares = [(1.0 - fx) * (1.0 - fy), fx * (1.0 - fy), (1.0 - fx) * fy, fx * fy];
        samples.push(Sample { at: [x.floor() as i32, y.floor() as i32], shares: shares.map(|s| s * weight) });
        weights += weight;
    }
    (samples, weights)
}

#[inline(always)]
fn hatched<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, band: &mut Band<'_>) {
    let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
    let (samples, weights) = samples(params);
    let source = &pass.inputs[0];
    for_blocks::<4>(
        band,
        #[inline(always)]
        |block, target| {
            let mut sum = zero;
            for sample in &samples {
                let [x, y] = sample.at;
                for (corner, share) in sample.shares.iter().enumerate() {
                    let (dx, dy) = (corner as i32 & 1, corner as i32 >> 1);
                    let [value, ..] = pixels_beside(simd, source, block, [x + dx, y + dy]);
                    sum = value.mul_add(f32x8::splat(simd, *share), sum);
                }
            }
            let value = ((sum / weights - 0.5) * params.gain + 0.5).within(zero, one);
            write([value, value, value, one], target);
        },
    );
}
