//! The rows of the Kuwahara filter's four subregions (§ 5.2): weighted sums to the left and to the right
//! of every pixel, of colours times coverage, of their squares and of the coverage.
//!
//! Equal weights are summed by doubling, log2(r + 1) additions a value: each sum is one of its own
//! pixels alone, so that a highlight leaves no rounding behind as it does in a running sum.
//!
//! Cost: 2 log2(r + 1) additions on five channels; other weights 10 multiply-adds each.
//! The shader takes all weights singly, through workgroup memory: count / 2 + 1 loads a pixel.

pub use crate::kernels::shaders::kuwahara_rows::Params;
use crate::kernels::simd::line_buffer::strips;
use crate::kernels::simd::moment_buffer::{CHANNELS, MomentBuffer};
use crate::kernels::simd::pixels::write;
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(kuwahara_rows {
    cpu: |simd, pass, params, band| rows(simd, pass, &params, band),
    cost: |p| {
        if p.flat_weights != 0 { 30.0 + 10.0 * f64::from(p.count).log2() } else { 10.0 * f64::from(p.count) }
    },
    tolerance: Tolerance::of_rounding(2e-6, 1e-5, "sums of up to 107 products in another order"),
});

/// Most weights of one side of a subregion.
pub const MAX_WEIGHTS: usize = 128;

/// Weights of one side of a subregion, packed as the uniform block wants it.
pub type Weights = [[f32; 4]; MAX_WEIGHTS / 4];

/// One axis of a subregion, from the pixel towards a side.
#[derive(Clone, Copy, Debug)]
pub struct Side {
    /// Offset of the first weight.
    pub first: i32,
    /// Weights, of sum 1.
    pub count: u32,
    /// All are equal.
    pub flat: bool,
    /// The weights.
    pub weights: Weights,
}

impl Side {
    /// The pixel and `radius` pixels on (5.1).
    pub fn square(radius: f32) -> Self {
        let count = (radius.round().max(0.0) as u32 + 1).min(MAX_WEIGHTS as u32);
        Self::new(0, count, true, |_| 1.0)
    }

    /// A Gaussian that has the mean and the variance of the square (§ 5.2.2), cut at 3 sigma.
    pub fn gaussian(radius: f32) -> Self {
        let radius = f64::from(radius.max(0.0));
        let (mean, sigma) = (0.5 * radius, (radius + 1.0) / 12f64.sqrt());
        let first = (mean - 3.0 * sigma).ceil() as i32;
        let last = (mean + 3.0 * sigma).floor() as i32;
        let count = ((last - first + 1) as u32).min(MAX_WEIGHTS as u32);
        Self::new(first, count, false, |d| (-0.5 * ((f64::from(d) - mean) / sigma).powi(2)).exp())
    }

    fn new(first: i32, count: u32, flat: bool, weight: impl Fn(i32) -> f64) -> Self {
        let sum: f64 = (0..count as i32).map(|i| weight(first + i)).sum();
        let mut weights = [[0.0; 4]; MAX_WEIGHTS / 4];
        for i in 0..count as usize {
            weights[i / 4][i % 4] = (weight(first + i as i32) / sum) as f32;
        }
        Self { first, count, flat, weights }
    }

    /// Pixels from the centre to the farthest weight.
    pub fn reach(&self) -> i32 {
        reach(self.first, self.count)
    }
}

/// Pixels from the centre to the farthest of `count` weights, of which the `first` is that of a pixel so far on.
fn reach(first: i32, count: u32) -> i32 {
    first.abs().max(first + count as i32 - 1)
}

/// Adds the pass. The outputs are the sums of (a r, a g, a b, a) to the left, the same to the right
/// (`sibling` 1), and of a (r^2 + g^2 + b^2) to the left and to the right (`sibling` 2).
pub fn pass(plan: &mut PlanBuilder, color: ImageId, side: &Side) -> ImageId {
    let params = Params {
        first: side.first,
        count: side.count,
        flat_weights: u32::from(side.flat),
        padding: Default::default(),
        weights: side.weights,
    };
    let level = plan.desc(color).level;
    plan.pass_at(&KERNEL, &[color], &params, &[Class::Field; 3], Support::Row(side.reach() as u32), level)
}

#[inline(always)]
fn rows<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, band: &mut Band<'_>) {
    let reach = reach(params.first, params.count);
    let window = band.window;
    let mut planes = MomentBuffer::default();
    let mut doubled = Vec::new();
    let mut sums: [[Vec<f32>; 2]; CHANNELS] = Default::default();
    let flat = params.flat_weights != 0;
    for (x0, x1) in strips(window.x0, window.x1) {
        planes.start(x0, x1, reach, 1);
        let len = (x1 - x0) as usize;
        for y in window.y0..window.y1 {
            planes.load(simd, &pass.inputs[0], y);
            for (channel, values) in planes.row(y).into_iter().enumerate() {
                let [left, right] = &mut sums[channel];
                if flat {
                    doubling(simd, values, params.count as usize, &mut doubled, left);
                } else {
                    let at = reach as usize;
                    convolved(simd, values, params, at, 1, len, right);
                    convolved(simd, values, params, at, -1, len, left);
                }
            }
            // Of equal weights, the window to the right of a pixel is that to the left of a later one.
            let places = if flat { [(0, 0), (0, reach as usize)] } else { [(0, 0), (1, 0)] };
            let columns = (x0 - window.x0) as usize..(x1 - window.x0) as usize;
            for (side, (sum, at)) in places.into_iter().enumerate() {
                let row = &mut band.row_mut(side, y)[4 * columns.start..4 * columns.end];
                for (i, target) in row.chunks_mut(32).enumerate() {
                    let mut pixels = [f32x8::splat(simd, 0.0); 4];
                    for (pixel, channel) in pixels.iter_mut().zip([0, 1, 2, 4]) {
                        *pixel = f32x8::from_slice(simd, &sums[channel][sum][at + 8 * i..at + 8 * i + 8]);
                    }
                    write(pixels, target);
                }
            }
            let row = &mut band.row_mut(2, y)[2 * columns.start..2 * columns.end];
            for (i, target) in row.chunks_mut(16).enumerate() {
                let mut pair = [f32x8::splat(simd, 0.0); 2];
                for (value, (sum, at)) in pair.iter_mut().zip(places) {
                    *value = f32x8::from_slice(simd, &sums[3][sum][at + 8 * i..at + 8 * i + 8]);
                }
                write(pair, target);
            }
        }
    }
}

/// Means of `count` values from every value on, in `out`: sums of 1, 2, 4, ... values, put together.
#[inline(always)]
fn doubling<S: Simd>(simd: S, values: &[f32], count: usize, doubled: &mut Vec<f32>, out: &mut Vec<f32>) {
    // Sums that begin near the end of the row reach past it; nobody reads them.
    let blocks = values.len() / 8;
    doubled.clear();
    doubled.extend_from_slice(values);
    doubled.resize(values.len() + 2 * count + 8, 0.0);
    out.clear();
    out.resize(values.len() + 8, 0.0);
    let (mut size, mut done) = (1, 0);
    loop {
        if count & size != 0 {
            for i in 0..blocks {
                let sum = f32x8::from_slice(simd, &out[8 * i..8 * i + 8])
                    + f32x8::from_slice(simd, &doubled[8 * i + done..8 * i + done + 8]);
                sum.store_slice(&mut out[8 * i..8 * i + 8]);
            }
            done += size;
        }
        if done == count {
            break;
        }
        for i in 0..blocks {
            let sum = f32x8::from_slice(simd, &doubled[8 * i..8 * i + 8])
                + f32x8::from_slice(simd, &doubled[8 * i + size..8 * i + size + 8]);
            sum.store_slice(&mut doubled[8 * i..8 * i + 8]);
        }
        size *= 2;
    }
    let share = f32x8::splat(simd, 1.0 / count as f32);
    for i in 0..blocks {
        (f32x8::from_slice(simd, &out[8 * i..8 * i + 8]) * share).store_slice(&mut out[8 * i..8 * i + 8]);
    }
}

/// Sums of weighted values around those from `at` on, towards a side.
#[inline(always)]
fn convolved<S: Simd>(
    simd: S,
    values: &[f32],
    params: &Params,
    at: usize,
    side: i32,
    len: usize,
    out: &mut Vec<f32>,
) {
    out.clear();
    out.resize(len.next_multiple_of(8), 0.0);
    for (block, target) in out.chunks_exact_mut(8).enumerate() {
        let mut sum = f32x8::splat(simd, 0.0);
        for i in 0..params.count as usize {
            let weight = f32x8::splat(simd, params.weights[i / 4][i % 4]);
            let start = (at + 8 * block) as i32 + side * (params.first + i as i32);
            sum = weight.mul_add(f32x8::from_slice(simd, &values[start as usize..start as usize + 8]), sum);
        }
        sum.store_slice(target);
    }
}
