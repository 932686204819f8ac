//! One axis of a separable Gaussian on four channels (2.21); the smoothing of colours and tensors.
//!
//! Cost: radius + 1 multiply-adds per value. Rows and columns run the same arithmetic on
//! interleaved values, four pixels to a vector.

use crate::kernels::support::{GaussianTable, gaussian_radius, gaussian_table};
use isophote_engine::fearless_simd::{Simd, dispatch, f32x16, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::params! {
    /// Uniform block.
    pub struct Params for gaussian_blur {
        /// (1, 0) for rows, (0, 1) for columns.
        pub axis: [i32; 2],
        /// Pixels on each side of the centre.
        pub radius: i32,
        /// Bit 0: multiply colour by alpha on reading. Bit 1: divide by alpha on writing.
        pub coverage: u32,
        /// Weights at distance 0, 1, ...
        pub weights: GaussianTable,
    }
}

crate::kernel!(gaussian_blur {
    cpu: run,
    cost: |params| {
        let p: Params = bytemuck::pod_read_unaligned(params);
        4.0 * (f64::from(p.radius) + 1.0)
    },
    tolerance: Tolerance {
        absolute: 1e-6,
        relative: 4e-6,
        outliers: 0.0,
        reason: "sums of up to 511 products in the same order; only fused multiply-adds differ",
    },
});

/// Cut-off of the window, in standard deviations.
const CUTOFF: f32 = 3.0;

/// Smooths four channels of any meaning by `sigma` pixels of the image's level.
pub fn smooth(plan: &mut PlanBuilder, image: ImageId, sigma: f32, class: Class) -> ImageId {
    both_axes(plan, image, sigma, class, [0, 0])
}

/// Smooths a colour by `sigma` pixels, weighting by coverage.
pub fn color(plan: &mut PlanBuilder, image: ImageId, sigma: f32) -> ImageId {
    both_axes(plan, image, sigma, Class::Colour, [1, 2])
}

fn both_axes(plan: &mut PlanBuilder, image: ImageId, sigma: f32, class: Class, coverage: [u32; 2]) -> ImageId {
    let radius = gaussian_radius(sigma, CUTOFF);
    let weights = gaussian_table(sigma, radius);
    let rows = Params { axis: [1, 0], radius: radius as i32, coverage: coverage[0], weights };
    let columns = Params { axis: [0, 1], coverage: coverage[1], ..rows };
    let half = plan.pass(&KERNEL, &[image], &rows, class, Support::Pixels(radius));
    plan.pass(&KERNEL, &[half], &columns, class, Support::Pixels(radius))
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    if params.axis[0] != 0 {
        dispatch!(pass.level, simd => rows(simd, pass, &params, band));
    } else {
        dispatch!(pass.level, simd => columns(simd, pass, &params, band));
    }
}

#[inline(always)]
fn rows<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, band: &mut Band<'_>) {
    let (mut scratch, mut covered) = (Vec::new(), Vec::new());
    let window = band.window;
    let r = params.radius;
    for y in window.y0..window.y1 {
        let mut source = pass.inputs[0].padded_row(y, window.x0 - r, window.x1 + r, &mut scratch);
        if params.coverage & 1 != 0 {
            premultiplied(source, &mut covered);
            source = &covered;
        }
        let target = band.row_mut(0, y);
        // Tap i of value v lies 4 i values to either side.
        let (centre, len) = (4 * r as usize, target.len());
        let mut v = 0;
        while v + 16 <= len {
            weighted(simd, params, #[inline(always)] |i| block(simd, source, (centre as i32 + 4 * i) as usize + v))
                .store_slice(&mut target[v..v + 16]);
            v += 16;
        }
        // The same lanes, the same order: a shorter block is padded with zeros.
        if v < len {
            let rest = len - v;
            let short = weighted(simd, params, #[inline(always)] |i| {
                part(simd, &source[(centre as i32 + 4 * i) as usize + v..][..rest])
            });
            target[v..].copy_from_slice(&short.to_array()[..rest]);
        }
        finish(params, target);
    }
}

#[inline(always)]
fn columns<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, band: &mut Band<'_>) {
    let window = band.window;
    let view = &pass.inputs[0];
    let (data, len) = (view.data(), 4 * window.width() as usize);
    let mut covered: Vec<Vec<f32>> = Vec::new();
    if params.coverage & 1 != 0 {
        covered.resize_with((window.height() as i32 + 2 * params.radius) as usize, Vec::new);
        for (i, row) in covered.iter_mut().enumerate() {
            let at = view.offset(window.x0, window.y0 - params.radius + i as i32);
            premultiplied(&data[at..at + len], row);
        }
    }
    for y in window.y0..window.y1 {
        let row = |i: i32| {
            if params.coverage & 1 != 0 {
                return covered[(y - window.y0 + params.radius + i) as usize].as_slice();
            }
            let at = view.offset(window.x0, y + i);
            &data[at..at + len]
        };
        let target = band.row_mut(0, y);
        let mut v = 0;
        while v + 16 <= len {
            weighted(simd, params, #[inline(always)] |i| block(simd, row(i), v))
                .store_slice(&mut target[v..v + 16]);
            v += 16;
        }
        if v < len {
            let rest = len - v;
            let short = weighted(simd, params, #[inline(always)] |i| part(simd, &row(i)[v..]));
            target[v..].copy_from_slice(&short.to_array()[..rest]);
        }
        finish(params, target);
    }
}

#[inline(always)]
fn block<S: Simd>(simd: S, values: &[f32], at: usize) -> f32x16<S> {
    f32x16::from_slice(simd, &values[at..at + 16])
}

/// A block that is shorter, padded with zeros.
#[inline(always)]
fn part<S: Simd>(simd: S, values: &[f32]) -> f32x16<S> {
    let mut block = [0.0; 16];
    block[..values.len()].copy_from_slice(values);
    f32x16::simd_from(simd, block)
}

#[inline(always)]
fn weighted<S: Simd>(simd: S, params: &Params, tap: impl Fn(i32) -> f32x16<S>) -> f32x16<S> {
    let mut sum = tap(0) * f32x16::splat(simd, params.weights[0][0]);
    for i in 1..=params.radius {
        let weight = params.weights[i as usize / 4][i as usize % 4];
        sum = (tap(-i) + tap(i)).mul_add(f32x16::splat(simd, weight), sum);
    }
    sum
}

fn premultiplied(source: &[f32], target: &mut Vec<f32>) {
    target.clear();
    target.extend(source.chunks_exact(4).flat_map(|p| [p[0] * p[3], p[1] * p[3], p[2] * p[3], p[3]]));
}

fn finish(params: &Params, row: &mut [f32]) {
    if params.coverage & 2 != 0 {
        for p in row.chunks_exact_mut(4) {
            let alpha = p[3];
            for c in &mut p[..3] {
                *c = if alpha > 1e-6 { *c / alpha } else { 0.0 };
            }
        }
    }
}
