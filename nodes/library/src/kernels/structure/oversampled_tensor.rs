//! The structure tensor of each gradient at twice the resolution (2.4.6): products of derivatives have
//! frequencies up to twice those of the picture, so only there are they sampled as they must be
//! (Figure 2.16). The derivatives are those of a Gaussian (2.22), by resampling convolution.
//!
//! Coverage as in `gradient_tensor`, with the picture's pixel around the place for its centre.
//!
//! Cost: 8 radius + 4 multiply-adds on four channels: columns are summed once, in the shader once
//! for the pixels of a workgroup, which makes 2/3 + radius / 4 columns of 2 radius + 1 loads a pixel.

pub use crate::kernels::shaders::oversampled_tensor::Params;
use crate::kernels::shared::coverage::premultiply;
use crate::kernels::shared::outer_product::outer_product;
use crate::kernels::simd::line_buffer::{LineBuffer, strips};
use crate::kernels::simd::pixels::{eight, write};
use crate::kernels::structure::gradient_tensor::Measure;
use isophote_engine::fearless_simd::prelude::*;
use isophote_engine::fearless_simd::{Simd, dispatch, f32x8};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

/// Entries of a table.
const TAPS: usize = 40;
/// Largest radius, in pixels of the picture.
const MAX_RADIUS: i32 = (TAPS as i32 - 1) / 2;

type Table = [[f32; 4]; TAPS / 4];

crate::kernel!(oversampled_tensor {
    cpu: run,
    cost: |p| {
        let taps = 2.0 * f64::from(p.radius) + 1.0;
        8.0 * taps * taps + 30.0
    },
    tolerance: Tolerance {
        absolute: 2e-6,
        relative: 1e-4,
        outliers: 0.002,
        reason: "differences of neighbours magnify the last bits of the colours, F may cancel over the \
                 channels, and a tensor at the threshold of validity goes either way",
    },
});

/// Adds the pass: colour to tensor at the next finer level, derivatives per pixel of the colour's own.
/// `sigma` is the standard deviation of the Gaussian in those pixels, cut at three of them.
pub fn pass(plan: &mut PlanBuilder, color: ImageId, sigma: f32, measure: Measure) -> ImageId {
    let (radius, smoothing, derivative) = tables(sigma);
    let params = Params {
        radius,
        flags: measure.flags(),
        scale: measure.scale,
        threshold: measure.least_lambda1(),
        smoothing,
        derivative,
    };
    let level = plan.desc(color).level - 1;
    plan.pass_at(&KERNEL, &[color], &params, &[Class::Field], Support::Pixels(radius as u32), level)
}

/// Radius and weights for a position 1/4 pixel beyond a pixel's centre. Constants have derivative 0 and
/// a ramp of slope 1 has derivative 1, which sampling and cutting would break.
fn tables(sigma: f32) -> (i32, Table, Table) {
    let sigma = f64::from(sigma).max(0.2);
    let radius = ((3.0 * sigma + 0.25).ceil() as i32).min(MAX_RADIUS);
    let distance = |j: i32| f64::from(j) - 0.25;
    let weight = |j: i32| (-distance(j).powi(2) / (2.0 * sigma * sigma)).exp();
    let total = |f: &dyn Fn(i32) -> f64| (-radius..=radius).map(|j| weight(j) * f(j)).sum::<f64>();
    let sum = total(&|_| 1.0);
    let mean = total(&distance) / sum;
    let slope = total(&|j| (distance(j) - mean).powi(2));
    let (mut smoothing, mut derivative) = (Table::default(), Table::default());
    for j in -radius..=radius {
        let i = (j + radius) as usize;
        smoothing[i / 4][i % 4] = (weight(j) / sum) as f32;
        derivative[i / 4][i % 4] = ((distance(j) - mean) * weight(j) / slope) as f32;
    }
    (radius, smoothing, derivative)
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    // A radius known to the compiler, that of the default, unrolls the sums.
    match params.radius {
        3 => dispatch!(pass.level, simd => tensors(simd, pass, &params, 3, band)),
        r => dispatch!(pass.level, simd => tensors(simd, pass, &params, r, band)),
    }
}

/// The two tables, flat, for one of the two positions in a pixel.
struct Weights {
    smoothing: [f32; TAPS],
    derivative: [f32; TAPS],
}

impl Weights {
    /// For the position before the pixel's centre, the mirror image, or beyond it.
    fn new(params: &Params, beyond: bool) -> Self {
        let (mut smoothing, mut derivative) = ([0.0; TAPS], [0.0; TAPS]);
        let last = 2 * params.radius as usize;
        for i in 0..=last {
            let (from, sign) = if beyond { (i, 1.0) } else { (last - i, -1.0) };
            smoothing[i] = params.smoothing[from / 4][from % 4];
            derivative[i] = sign * params.derivative[from / 4][from % 4];
        }
        Self { smoothing, derivative }
    }
}

#[inline(always)]
fn tensors<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, radius: i32, band: &mut Band<'_>) {
    let window = band.window;
    let view = &pass.inputs[0];
    let r = radius as usize;
    let phases = [Weights::new(params, false), Weights::new(params, true)];
    let mut rows = LineBuffer::default();
    // Column sums of one row: smoothed and derived, four channels each; and the row's tensors.
    let (mut columns, mut wide): (Vec<f32>, Vec<f32>) = (Vec::new(), Vec::new());
    for (x0, x1) in strips(window.x0 >> 1, (window.x1 + 1) >> 1) {
        rows.start(x0, x1, radius, 4);
        let len = rows.stride();
        columns.resize(8 * len, 0.0);
        let blocks = ((x1 - x0) as usize).div_ceil(8);
        wide.resize(64 * blocks, 0.0);
        let mut next = (window.y0 >> 1) - radius;
        for y in window.y0..window.y1 {
            let row = y >> 1;
            while next <= row + radius {
                rows.load_mapped(simd, view, next, premultiply);
                next += 1;
            }
            for (channel, sums) in columns.chunks_exact_mut(2 * len).enumerate() {
                sum_columns(simd, &rows, &phases[(y & 1) as usize], r, row, channel, sums);
            }
            for (i, block) in wide.chunks_exact_mut(64).enumerate() {
                let [low, high] = pairs(simd, params, &phases, r, &rows, row, &columns, 8 * i);
                write(low, &mut block[..32]);
                write(high, &mut block[32..]);
            }
            let (from, to) = ((2 * x0).max(window.x0), (2 * x1).min(window.x1));
            let at = |x: i32, first: i32| 4 * (x - first) as usize;
            band.row_mut(0, y)[at(from, window.x0)..at(to, window.x0)]
                .copy_from_slice(&wide[at(from, 2 * x0)..at(to, 2 * x0)]);
        }
    }
}

/// The tensors at both positions of eight pixels of row `y`, side by side, from column `at` of the strip on.
#[inline(always)]
fn pairs<S: Simd>(
    simd: S,
    params: &Params,
    phases: &[Weights; 2],
    radius: usize,
    rows: &LineBuffer,
    y: i32,
    columns: &[f32],
    at: usize,
) -> [[f32x8<S>; 4]; 2] {
    let (zero, len) = (f32x8::splat(simd, 0.0), rows.stride());
    let mut centre = [zero; 4];
    for c in 0..4 {
        centre[c] = f32x8::from_slice(simd, &rows.row(y, c)[at + radius..at + radius + 8]);
    }
    let mut both = [[zero; 4]; 2];
    for phase in 0..2 {
        let mut gradients = [[zero; 2]; 4];
        for c in 0..4 {
            let sums = columns[2 * c * len..][..2 * len].split_at(len);
            gradients[c] = gradient(simd, &phases[phase], radius, sums, at);
        }
        let (flags, scale, threshold) = (params.flags, params.scale, params.threshold);
        both[phase] = outer_product(simd, flags, scale, threshold, centre, gradients);
    }
    let (mut low, mut high) = ([zero; 4], [zero; 4]);
    for c in 0..4 {
        (low[c], high[c]) = both[0][c].interleave(both[1][c]);
    }
    [low, high]
}

/// Smooths and derives along the columns: one channel around row `y`, first all smoothed, then all
/// derived. Derivatives are sums of differences from the middle: where all is flat they are exactly 0.
#[inline(always)]
fn sum_columns<S: Simd>(
    simd: S,
    rows: &LineBuffer,
    weights: &Weights,
    radius: usize,
    y: i32,
    channel: usize,
    sums: &mut [f32],
) {
    let (smoothed, derived) = sums.split_at_mut(rows.stride());
    let mut taps: [&[f32]; TAPS] = [&[]; TAPS];
    for (k, tap) in taps[..=2 * radius].iter_mut().enumerate() {
        *tap = rows.row(y + k as i32 - radius as i32, channel);
    }
    let blocks = smoothed.chunks_exact_mut(8).zip(derived.chunks_exact_mut(8));
    for (i, (smoothed, derived)) in blocks.enumerate() {
        let (mut s, mut d) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 0.0));
        let middle = f32x8::from_slice(simd, &taps[radius][8 * i..8 * i + 8]);
        for (k, tap) in taps[..=2 * radius].iter().enumerate() {
            let tap = f32x8::from_slice(simd, &tap[8 * i..8 * i + 8]);
            s = tap.mul_add(f32x8::splat(simd, weights.smoothing[k]), s);
            d = (tap - middle).mul_add(f32x8::splat(simd, weights.derivative[k]), d);
        }
        s.store_slice(smoothed);
        d.store_slice(derived);
    }
}

/// The gradient of one channel from its column sums.
#[inline(always)]
fn gradient<S: Simd>(
    simd: S,
    weights: &Weights,
    radius: usize,
    (smoothed, derived): (&[f32], &[f32]),
    at: usize,
) -> [f32x8<S>; 2] {
    let (mut x, mut y) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 0.0));
    let last = at + 2 * radius + 8;
    let (smoothed, derived) = (&smoothed[at..last], &derived[at..last]);
    let middle = eight(simd, smoothed, radius);
    for k in 0..=2 * radius {
        let (s, d) = (&smoothed[k..k + 8], &derived[k..k + 8]);
        let s = f32x8::from_slice(simd, s) - middle;
        x = s.mul_add(f32x8::splat(simd, weights.derivative[k]), x);
        y = f32x8::from_slice(simd, d).mul_add(f32x8::splat(simd, weights.smoothing[k]), y);
    }
    [x, y]
}
