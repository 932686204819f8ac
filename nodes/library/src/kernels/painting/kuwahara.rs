//! The Kuwahara filter (§ 5.2) from sums over the rows of its subregions: the mean of the subregion with
//! the least variance. Subregions whose variances differ by rounding only share the result, so that
//! slopes and flat parts lean to no side.
//!
//! Equal weights are summed over blocks of r + 1 rows at fixed places, from the block's ends inwards:
//! every sum is put together from two such, whatever the radius, and holds none but its own pixels.
//!
//! Cost: 3 additions on ten channels and 60 operations; other weights 20 multiply-adds each.
//! The shader takes all weights singly, through workgroup memory: 3 count / 2 + 4 loads a pixel.

use crate::kernels::painting::kuwahara_rows::{self, Side};
pub use crate::kernels::shaders::kuwahara::Params;
use crate::kernels::simd::pixels::{Block, read, write};
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance, View, memory};

crate::kernel!(kuwahara {
    cpu: |simd, pass, params, band| columns(simd, pass, &params, band),
    cost: |p| 60.0 + if p.flat_weights != 0 { 30.0 } else { 20.0 * f64::from(p.count) },
    tolerance: Tolerance {
        absolute: 1e-4,
        relative: 1e-4,
        outliers: 0.01,
        reason: "the last bit decides between subregions of nearly equal variance",
    },
});

const TIE: f32 = 1e-3;

/// Rounding of a variance, as a share of the mean square.
const ROUNDING: f32 = 4e-6;

/// A subregion of which less than this share is covered says nothing.
const SEEN: f32 = 1e-3;

/// Columns of a strip: its rows and their sums stay in the second-level cache.
const STRIP: i32 = 32;

/// Filters a colour.
pub fn pass(plan: &mut PlanBuilder, color: ImageId, side: &Side) -> ImageId {
    let left = kuwahara_rows::pass(plan, color, side);
    let (right, squares) = (plan.sibling(left, 1), plan.sibling(left, 2));
    let params = Params {
        first: side.first,
        count: side.count,
        flat_weights: u32::from(side.flat),
        tie: TIE,
        weights: side.weights,
    };
    let support = Support::Column(side.reach() as u32);
    let level = plan.desc(color).level;
    plan.pass_at(&KERNEL, &[left, right, squares, color], &params, &[Class::Colour], support, level)
}

/// A strip of columns of the sums over rows: ten values a pixel, four of the left, four of the right and
/// two of the squares, kept apart.
struct Strip<'a> {
    inputs: [View<'a>; 3],
    x0: i32,
    x1: i32,
}

impl Strip<'_> {
    /// Columns, filled up to whole vectors with columns that hold nothing.
    fn padded(&self) -> usize {
        ((self.x1 - self.x0) as usize).next_multiple_of(8)
    }

    fn len(&self) -> usize {
        10 * self.padded()
    }

    /// Adds row `y` times `weight` to `sum`.
    #[inline(always)]
    fn add<S: Simd>(&self, simd: S, y: i32, weight: f32, sum: &mut [f32]) {
        let (width, padded) = ((self.x1 - self.x0) as usize, self.padded());
        let (left, rest) = sum.split_at_mut(4 * padded);
        let (right, squares) = rest.split_at_mut(4 * padded);
        let (left, right) = (&mut left[..4 * width], &mut right[..4 * width]);
        let squares = &mut squares[..2 * width];
        let w = f32x8::splat(simd, weight);
        for (view, sum) in self.inputs.iter().zip([left, right, squares]) {
            let at = view.offset(self.x0, y);
            let values = &view.data()[at..at + sum.len()];
            let (full, short) = sum.split_at_mut(sum.len() / 8 * 8);
            let (values, last) = values.split_at(full.len());
            for (sum, values) in full.chunks_exact_mut(8).zip(values.chunks_exact(8)) {
                let total = w.mul_add(f32x8::from_slice(simd, values), f32x8::from_slice(simd, sum));
                total.store_slice(sum);
            }
            if !short.is_empty() {
                let (mut a, mut b) = ([0.0; 8], [0.0; 8]);
                a[..short.len()].copy_from_slice(last);
                b[..short.len()].copy_from_slice(short);
                let total = w.mul_add(f32x8::from_slice(simd, &a), f32x8::from_slice(simd, &b)).to_array();
                short.copy_from_slice(&total[..short.len()]);
            }
        }
    }
}

#[inline(always)]
fn columns<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, band: &mut Band<'_>) {
    let window = band.window;
    let inputs = [pass.inputs[0], pass.inputs[1], pass.inputs[2]];
    let [mut table, mut above, mut below] = [const { Vec::new() }; 3];
    for x0 in (window.x0..window.x1).step_by(STRIP as usize) {
        let strip = Strip { inputs, x0, x1: (x0 + STRIP).min(window.x1) };
        let len = strip.len();
        let last = params.count as i32 - 1;
        if params.flat_weights != 0 {
            blocks(simd, &strip, params, [window.y0 - last, window.y1], &mut table);
        }
        for y in window.y0..window.y1 {
            let sums = if params.flat_weights != 0 {
                let row = |y: i32| &table[(y - window.y0 + last) as usize * len..][..len];
                [row(y), row(y - last)]
            } else {
                for (sum, side) in [(&mut below, 1), (&mut above, -1)] {
                    sum.clear();
                    sum.resize(len, 0.0);
                    for i in 0..params.count as usize {
                        let weight = params.weights[i / 4][i % 4];
                        strip.add(simd, y + side * (params.first + i as i32), weight, sum);
                    }
                }
                [below.as_slice(), above.as_slice()]
            };
            let columns = (x0 - window.x0) as usize..(strip.x1 - window.x0) as usize;
            let row = &mut band.row_mut(0, y)[4 * columns.start..4 * columns.end];
            for (i, target) in row.chunks_mut(32).enumerate() {
                let original = Block::until(strip.x1, x0 + 8 * i as i32, y).read(simd, &pass.inputs[3]);
                write(mean_of_flattest(simd, params, sums, len / 10, 8 * i, original), target);
            }
        }
    }
}

/// Means over `count` rows from each of the rows `y0..y1` on.
#[inline(always)]
fn blocks<S: Simd>(simd: S, strip: &Strip<'_>, params: &Params, [y0, y1]: [i32; 2], table: &mut Vec<f32>) {
    let (count, len) = (params.count as i32, strip.len());
    let weight = params.weights[0][0];
    table.clear();
    memory::resize(table, (y1 - y0) as usize * len, 0.0);
    let mut sum = vec![0.0; len];
    let mut block = y0.div_euclid(count) * count;
    while block < y1 {
        sum.fill(0.0);
        for y in (block.max(y0)..block + count).rev() {
            strip.add(simd, y, weight, &mut sum);
            if y < y1 {
                table[(y - y0) as usize * len..][..len].copy_from_slice(&sum);
            }
        }
        sum.fill(0.0);
        for y in block + 1..(block + count).min(y1) {
            strip.add(simd, y + count - 1, weight, &mut sum);
            if y >= y0 {
                for (total, sum) in table[(y - y0) as usize * len..][..len].iter_mut().zip(&sum) {
                    *total += sum;
                }
            }
        }
        block += count;
    }
}

/// The mean of the subregions of least variance, for eight pixels from `at` on.
#[inline(always)]
fn mean_of_flattest<S: Simd>(
    simd: S,
    params: &Params,
    [below, above]: [&[f32]; 2],
    width: usize,
    at: usize,
    original: [f32x8<S>; 4],
) -> [f32x8<S>; 4] {
    let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
    let mut squares = [[zero; 2]; 2];
    for (squares, sums) in squares.iter_mut().zip([below, above]) {
        *squares = read(simd, &sums[8 * width + 2 * at..][..16]);
    }
    let regions = [
        (&below[4 * at..4 * width], squares[0][0]),
        (&below[4 * (width + at)..8 * width], squares[0][1]),
        (&above[4 * (width + at)..8 * width], squares[1][1]),
        (&above[4 * at..4 * width], squares[1][0]),
    ];
    let mut means = [[zero; 3]; 4];
    let mut covers = [zero; 4];
    let mut variances = [zero; 4];
    let mut mean_squares = [zero; 4];
    let mut least = f32x8::splat(simd, 3e38);
    for (k, (sums, square)) in regions.into_iter().enumerate() {
        let [r, g, b, a] = read(simd, &sums[..32]);
        let seen = a.simd_gt(f32x8::splat(simd, SEEN));
        let n = seen.select(one / a, zero);
        let mean = [r * n, g * n, b * n];
        let mean_square = square * n;
        let variance = mean_square - mean[2].mul_add(mean[2], mean[1].mul_add(mean[1], mean[0] * mean[0]));
        variances[k] = seen.select(variance.at_least(zero), f32x8::splat(simd, 3e38));
        least = least.at_most(variances[k]);
        (means[k], covers[k], mean_squares[k]) = (mean, seen.select(a, zero), mean_square);
    }
    let limit = least * (1.0 + params.tie);
    let mut sum = [zero; 4];
    for k in 0..4 {
        let limit = mean_squares[k].mul_add(f32x8::splat(simd, ROUNDING), limit);
        let share = variances[k].simd_le(limit).select(covers[k], zero);
        for (sum, mean) in sum.iter_mut().zip(means[k]) {
            *sum = share.mul_add(mean, *sum);
        }
        sum[3] += share;
    }
    let seen = sum[3].simd_gt(zero);
    let n = one / seen.select(sum[3], one);
    let [r, g, b, a] = original;
    [seen.select(sum[0] * n, r), seen.select(sum[1] * n, g), seen.select(sum[2] * n, b), a]
}
