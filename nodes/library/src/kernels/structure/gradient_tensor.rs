//! The structure tensor of each pixel's gradient (2.34), by a separable derivative operator: central
//! differences (2.18), Sobel (2.23), the optimized 3x3 and 5x5 operators (2.26-2.29) and Gaussian
//! derivatives (2.22). Listing 2.2.
//!
//! Coverage: a tap counts by its alpha, and as far as it is transparent it stands for the colour of
//! the centre; the centre's own alpha weights the gradient. With premultiplied colour P and alpha A
//! that is A grad P - P grad A = A^2 grad(P / A). Hidden colours have no part in it, and where all
//! is opaque it is the plain gradient to the last bit.
//!
//! Cost: 4 radius + 2 multiply-adds on four channels: columns are summed once, in the shader once
//! for the pixels of a workgroup, which makes 1 + radius / 4 columns of 2 radius + 1 loads a pixel.

pub use crate::kernels::shaders::gradient_tensor::Params;
use crate::kernels::shared::coverage::premultiply;
use crate::kernels::shared::outer_product::outer_product;
use crate::kernels::simd::line_buffer::{LineBuffer, Row, WIDE_STRIP, for_rows};
use crate::kernels::simd::pixels::{BLOCK, eight, write};
use isophote_engine::fearless_simd::prelude::*;
use isophote_engine::fearless_simd::{Simd, dispatch, f32x8};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

/// Entries of a table, the centre included.
const TAPS: usize = 20;
/// Largest radius of an operator, in pixels.
const MAX_RADIUS: u32 = TAPS as u32 - 1;

type Table = [[f32; 4]; TAPS / 4];

crate::kernel!(gradient_tensor {
    cpu: run,
    cost: |p| {
        let r = f64::from(p.radius);
        16.0 * r * (2.0 * r + 1.0) + 30.0
    },
    tolerance: Tolerance {
        absolute: 2e-6,
        relative: 1e-4,
        outliers: 0.002,
        reason: "differences of neighbours magnify the last bits of the colours, F may cancel over the \
                 channels, and a tensor at the threshold of validity goes either way",
    },
});

/// Operator that takes derivatives (§ 2.2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Derivative {
    /// Central differences (2.18).
    Central,
    /// The Sobel operator (2.23).
    Sobel,
    /// The 3x3 operator optimized for rotation invariance (2.26, 2.27).
    Scharr3,
    /// The 5x5 operator optimized for rotation invariance (2.28, 2.29).
    Scharr5,
    /// Derivatives of a Gaussian of this standard deviation in pixels (2.22), cut at three of them.
    Gaussian(f32),
}

impl Derivative {
    /// Variance, in square pixels, of the window that the derivative is a mean over, the mean of both
    /// directions; 0 for Gaussians, whose width is a length of the picture.
    pub fn variance(self) -> f32 {
        if let Self::Gaussian(_) = self {
            return 0.0;
        }
        let (radius, smoothing, derivative) = self.tables();
        let moment = |table: &Table, power: i32| {
            (1..=radius as usize).map(|i| 2.0 * (i as f32).powi(power) * table[i / 4][i % 4]).sum::<f32>()
        };
        // A derivative is the slope of a mean; its third moment is three times that mean's second.
        0.5 * (moment(&smoothing, 2) + moment(&derivative, 3) / 3.0)
    }

    /// Radius, smoothing weights and derivative weights. A ramp of slope 1 has derivative 1.
    fn tables(self) -> (u32, Table, Table) {
        let optimized = |v: f32| v / 256.0;
        match self {
            Self::Central => tables(&[1.0], &[0.0, 0.5]),
            Self::Sobel => tables(&[0.5, 0.25], &[0.0, 0.5]),
            Self::Scharr3 => tables(&[optimized(162.32), optimized(46.84)], &[0.0, 0.5]),
            Self::Scharr5 => tables(
                &[optimized(120.64), optimized(61.77), optimized(5.91)],
                &[0.0, optimized(85.46), optimized(21.27)],
            ),
            Self::Gaussian(sigma) => {
                // Below 0.2 the weights next to the centre vanish; the limit is central differences.
                let sigma = f64::from(sigma).max(0.2);
                let radius = ((3.0 * sigma).ceil() as u32).clamp(1, MAX_RADIUS);
                let weight = |i: u32| (-f64::from(i * i) / (2.0 * sigma * sigma)).exp();
                // Sampling and cutting would lose some of the slope: normalise to a ramp's.
                let sum = weight(0) + 2.0 * (1..=radius).map(weight).sum::<f64>();
                let slope = 2.0 * (1..=radius).map(|i| f64::from(i * i) * weight(i)).sum::<f64>();
                let (mut smoothing, mut derivative) = ([0.0; TAPS], [0.0; TAPS]);
                for i in 0..=radius {
                    smoothing[i as usize] = (weight(i) / sum) as f32;
                    derivative[i as usize] = (f64::from(i) * weight(i) / slope) as f32;
                }
                let kept = ..=radius as usize;
                tables(&smoothing[kept], &derivative[kept])
            }
        }
    }
}

fn tables(smoothing: &[f32], derivative: &[f32]) -> (u32, Table, Table) {
    let pack = |weights: &[f32]| {
        let mut table = Table::default();
        for (i, weight) in weights.iter().enumerate() {
            table[i / 4][i % 4] = *weight;
        }
        table
    };
    (derivative.len() as u32 - 1, pack(smoothing), pack(derivative))
}

/// Measure that the tensor is taken of, beside the operator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measure {
    /// Factor on the colours: 1 for gamma-encoded RGB, 1/100 for CIELAB.
    pub scale: f32,
    /// The gradient of the Rec. 709 luma alone instead of all three channels.
    pub luma: bool,
    /// Divide each channel's tensor by its gradient's magnitude (2.133).
    pub normalize: bool,
    /// w is 1 where sqrt(lambda1) is above this, else 0; none: 1 everywhere.
    pub threshold: Option<f32>,
}

impl Measure {
    /// `flags` of the uniform block.
    pub(crate) fn flags(self) -> u32 {
        u32::from(self.luma) | u32::from(self.normalize) << 1
    }

    /// lambda1 above which a tensor counts as valid.
    pub(crate) fn least_lambda1(self) -> f32 {
        least_lambda1(self.threshold)
    }
}

/// lambda1 above which a tensor counts as valid; below any lambda1 when all do.
pub(crate) fn least_lambda1(threshold: Option<f32>) -> f32 {
    threshold.map_or(-1.0, |t| t * t)
}

/// Adds the pass: colour to tensor.
pub fn pass(plan: &mut PlanBuilder, color: ImageId, operator: Derivative, measure: Measure) -> ImageId {
    let (radius, smoothing, derivative) = operator.tables();
    let params = Params {
        radius: radius as i32,
        flags: measure.flags(),
        scale: measure.scale,
        threshold: measure.least_lambda1(),
        smoothing,
        derivative,
    };
    plan.pass(&KERNEL, &[color], &params, Class::Field, Support::Pixels(radius))
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    // A radius known to the compiler unrolls the sums of the common operators.
    match params.radius {
        1 => dispatch!(pass.level, simd => tensors(simd, pass, &params, 1, band)),
        2 => dispatch!(pass.level, simd => tensors(simd, pass, &params, 2, band)),
        r => dispatch!(pass.level, simd => tensors(simd, pass, &params, r, band)),
    }
}

/// The two tables, flat.
struct Weights {
    smoothing: [f32; TAPS],
    derivative: [f32; TAPS],
}

#[inline(always)]
fn tensors<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, radius: i32, band: &mut Band<'_>) {
    let r = radius as usize;
    let flat = |table: &Table| std::array::from_fn(|i| table[i / 4][i % 4]);
    let weights = Weights { smoothing: flat(&params.smoothing), derivative: flat(&params.derivative) };
    let zero = f32x8::splat(simd, 0.0);
    // Column sums of one row: smoothed and derived, four channels each.
    let mut columns: Vec<f32> = Vec::new();
    for_rows::<S, 4>(
        simd,
        &pass.inputs[0],
        band,
        [WIDE_STRIP, radius],
        premultiply,
        #[inline(always)]
        |Row { buffer, y, .. }, target| {
            let len = buffer.stride();
            columns.resize(8 * len, 0.0);
            for (channel, sums) in columns.chunks_exact_mut(2 * len).enumerate() {
                sum_columns(simd, buffer, &weights, r, y, channel, sums);
            }
            let centres = buffer.channels(y);
            let sums: [[&[f32]; 2]; 4] = std::array::from_fn(|c| {
                let (smoothed, derived) = columns[2 * c * len..][..2 * len].split_at(len);
                [smoothed, derived]
            });
            for (i, pixels) in target.chunks_mut(4 * BLOCK).enumerate() {
                let at = r + BLOCK * i;
                // Loops, not closures given to arrays: those stay calls, and every operation in them one.
                let (mut centre, mut gradients) = ([zero; 4], [[zero; 2]; 4]);
                for c in 0..4 {
                    centre[c] = eight(simd, centres[c], at);
                    gradients[c] = gradient(simd, &weights, r, sums[c], at);
                }
                let (flags, scale, threshold) = (params.flags, params.scale, params.threshold);
                write(outer_product(simd, flags, scale, threshold, centre, gradients), pixels);
            }
        },
    );
}

/// Smooths and derives along the columns: one channel of row `y`, first all smoothed, then all derived.
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
    let mut taps: [&[f32]; 2 * TAPS] = [&[]; 2 * TAPS];
    for (k, tap) in taps[..=2 * radius].iter_mut().enumerate() {
        *tap = rows.row(y - radius as i32 + k as i32, channel);
    }
    let blocks = smoothed.chunks_exact_mut(8).zip(derived.chunks_exact_mut(8));
    for (i, (smoothed, derived)) in blocks.enumerate() {
        let mut s = eight(simd, taps[radius], 8 * i) * weights.smoothing[0];
        let mut d = f32x8::splat(simd, 0.0);
        for j in 1..=radius {
            let (above, below) = (eight(simd, taps[radius - j], 8 * i), eight(simd, taps[radius + j], 8 * i));
            s = (above + below).mul_add(f32x8::splat(simd, weights.smoothing[j]), s);
            d = (below - above).mul_add(f32x8::splat(simd, weights.derivative[j]), d);
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
    [smoothed, derived]: [&[f32]; 2],
    at: usize,
) -> [f32x8<S>; 2] {
    let (mut x, mut y) = (f32x8::splat(simd, 0.0), eight(simd, derived, at) * weights.smoothing[0]);
    for i in 1..=radius {
        let difference = eight(simd, smoothed, at + i) - eight(simd, smoothed, at - i);
        let sum = eight(simd, derived, at - i) + eight(simd, derived, at + i);
        x = difference.mul_add(f32x8::splat(simd, weights.derivative[i]), x);
        y = sum.mul_add(f32x8::splat(simd, weights.smoothing[i]), y);
    }
    [x, y]
}
