//! One axis of a separable Gaussian on four channels (2.21); the smoothing of colours and tensors.
//!
//! Cost: radius + 1 multiply-adds per value. Rows and columns run the same arithmetic on
//! interleaved values, sixteen pixels at a time. The shader reads its windows through workgroup memory,
//! radius / 2 + 2 loads a pixel.

pub use crate::kernels::shaders::gaussian_blur::Params;
use crate::kernels::shared::coverage::{FULL, LEAST_COVERAGE, is_opaque};
use crate::kernels::simd::window_sum::{GAUSSIAN_TAPS, RUN, flat, gaussian_radius, gaussian_table, sum};
use isophote_engine::fearless_simd::{Simd, dispatch, f32x4, f32x16, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(gaussian_blur {
    cpu: run,
    cost: |p| 4.0 * (f64::from(p.radius) + 1.0),
    tolerance: Tolerance::of_rounding(
        1e-6,
        4e-6,
        "sums of up to 511 products in the same order; only fused multiply-adds differ"
    ),
    pair: is_window,
});

/// True where two passes are the rows and the columns of a window.
fn is_window(rows: &[u8], columns: &[u8]) -> bool {
    let [rows, columns]: [Params; 2] = [rows, columns].map(bytemuck::pod_read_unaligned);
    (rows.axis, columns.axis) == ([1, 0], [0, 1])
        && (rows.radius, rows.weights) == (columns.radius, columns.weights)
}

/// Cut-off of the window, in standard deviations.
const CUTOFF: f32 = 3.0;

/// Smooths four channels of any meaning by `sigma` pixels of the image's level.
pub fn pass(plan: &mut PlanBuilder, image: ImageId, sigma: f32, class: Class) -> ImageId {
    both_axes(plan, image, sigma, class, [0, 0])
}

/// Smooths a colour by `sigma` pixels, weighting by coverage.
pub fn pass_colour(plan: &mut PlanBuilder, image: ImageId, sigma: f32) -> ImageId {
    both_axes(plan, image, sigma, Class::Colour, [1, 2])
}

fn both_axes(
    plan: &mut PlanBuilder,
    image: ImageId,
    sigma: f32,
    class: Class,
    coverage: [u32; 2],
) -> ImageId {
    let radius = gaussian_radius(sigma, CUTOFF);
    let weights = gaussian_table(sigma, radius);
    let rows = Params { axis: [1, 0], radius: radius as i32, coverage: coverage[0], weights };
    let columns = Params { axis: [0, 1], coverage: coverage[1], ..rows };
    let half = plan.pass(&KERNEL, &[image], &rows, class, Support::Row(radius));
    plan.pass(&KERNEL, &[half], &columns, class, Support::Column(radius))
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
    let weights = flat(&params.weights);
    let window = band.window;
    let r = params.radius;
    for y in window.y0..window.y1 {
        let mut source = pass.inputs[0].padded_row(y, window.x0 - r, window.x1 + r, &mut scratch);
        if params.coverage & 1 != 0 && premultiplied(source, &mut covered) {
            source = &covered;
        }
        for (n, target) in band.row_mut(0, y).chunks_mut(RUN).enumerate() {
            // Tap i of value v lies 4 i values to either side.
            smoothed(
                simd,
                params,
                &weights,
                #[inline(always)]
                |i| &source[4 * i + RUN * n..],
                target,
            );
        }
    }
}

#[inline(always)]
fn columns<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, band: &mut Band<'_>) {
    let window = band.window;
    let view = &pass.inputs[0];
    let (data, len) = (view.data(), 4 * window.width() as usize);
    let weights = flat(&params.weights);
    let r = params.radius;
    let count = window.height() as usize + 2 * r as usize;
    let mut covered = vec![Vec::new(); if params.coverage & 1 != 0 { count } else { 0 }];
    let mut rows: Vec<&[f32]> = Vec::with_capacity(count);
    for y in window.y0 - r..window.y1 + r {
        let at = view.offset(window.x0, y);
        rows.push(&data[at..at + len]);
    }
    for (row, covered) in rows.iter_mut().zip(&mut covered) {
        if premultiplied(row, covered) {
            *row = covered;
        }
    }
    for (y, rows) in (window.y0..window.y1).zip(rows.windows(2 * r as usize + 1)) {
        for (n, target) in band.row_mut(0, y).chunks_mut(RUN).enumerate() {
            smoothed(
                simd,
                params,
                &weights,
                #[inline(always)]
                |i| &rows[i][RUN * n..],
                target,
            );
        }
    }
}

/// Up to a run of values.
#[inline(always)]
fn smoothed<'s, S: Simd>(
    simd: S,
    params: &Params,
    weights: &[f32; GAUSSIAN_TAPS],
    tap: impl Fn(usize) -> &'s [f32],
    target: &mut [f32],
) {
    sum(
        simd,
        params.radius as usize,
        #[inline(always)]
        |i| f32x16::splat(simd, weights[i]),
        tap,
        target,
    );
    if params.coverage & 2 != 0 {
        for pixel in target.chunks_exact_mut(4) {
            let alpha = pixel[3];
            let seen = f32x4::from_slice(simd, pixel) / alpha.max(LEAST_COVERAGE);
            let seen = if alpha > LEAST_COVERAGE { seen } else { f32x4::splat(simd, 0.0) };
            seen.store_slice(pixel);
            pixel[3] = if alpha > FULL { 1.0 } else { alpha };
        }
    }
}

/// Multiplies colours by their alpha, unless all of them are 1: says whether there was need to.
fn premultiplied(source: &[f32], target: &mut Vec<f32>) -> bool {
    if is_opaque(source) {
        return false;
    }
    target.clear();
    target.extend(source.chunks_exact(4).flat_map(|p| [p[0] * p[3], p[1] * p[3], p[2] * p[3], p[3]]));
    true
}
