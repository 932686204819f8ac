//! Columns of two Gaussians at once, their difference and its threshold: the second half of the
//! isotropic extended difference of Gaussians (4.7-4.10).
//!
//! Cost: one multiply-add per tap and value (four values a pixel), radius + 1 taps; two divisions
//! and the threshold. Sixteen interleaved pixels at a time. The shader reads its windows through workgroup
//! memory, radius / 2 + 2 loads a pixel.

use crate::kernels::lines::dog_rows;
pub use crate::kernels::shaders::dog_columns::Params;
use crate::kernels::shared::edge_threshold::{Xdog, dog_of_sums, edge_of_response, edge_uncovered};
use crate::kernels::simd::pixels::{BLOCK, read, write};
use crate::kernels::simd::window_sum::{RUN, flat, sum};
use isophote_engine::fearless_simd::{Simd, f32x8, f32x16, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(dog_columns {
    cpu: |simd, pass, params, band| columns(simd, pass, &params, band),
    cost: |p| 4.0 * (f64::from(p.radius) + 1.0) + 25.0,
    tolerance: Tolerance {
        absolute: 2e-3,
        relative: 1e-5,
        outliers: 2e-3,
        reason: "rounding of L (up to 5e-5, more in HDR) times the weight of the difference and phi; \
                 a binary threshold may go the other way on the last bit",
    },
});

/// Options of a difference of Gaussians.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Standard deviation of the narrower Gaussian, pixels.
    pub sigma: f32,
    /// Ratio of the two standard deviations.
    pub k: f32,
    /// Weights and threshold.
    pub xdog: Xdog,
}

/// The edge image of (L alpha, alpha): difference of Gaussians of standard deviations `sigma` and
/// `k` `sigma` pixels, weighted and thresholded as `xdog` says.
pub fn pass(plan: &mut PlanBuilder, lightness: ImageId, options: &Options) -> ImageId {
    let Options { sigma, k, xdog } = *options;
    let rows = dog_rows::pass(plan, lightness, sigma, k);
    let (radius, narrow, wide) = dog_rows::tables(sigma, k);
    let params = Params {
        radius: radius as i32,
        threshold: xdog.threshold as u32,
        base: xdog.base,
        edge: xdog.edge,
        epsilon: xdog.epsilon,
        phi: xdog.phi,
        faintness: xdog.faintness,
        padding: Default::default(),
        narrow,
        wide,
    };
    plan.pass(&KERNEL, &[rows], &params, Class::Field, Support::Column(radius))
}

#[inline(always)]
fn columns<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, band: &mut Band<'_>) {
    let (window, view) = (band.window, &pass.inputs[0]);
    let (data, len) = (view.data(), 4 * window.width() as usize);
    let (narrow, wide) = (flat(&params.narrow), flat(&params.wide));
    let r = params.radius;
    let mut weights: Vec<[f32; 16]> = Vec::with_capacity(r as usize + 1);
    for i in 0..=r as usize {
        let (n, w) = (narrow[i], wide[i]);
        weights.push([n, n, w, w, n, n, w, w, n, n, w, w, n, n, w, w]);
    }
    let uncovered = edge_uncovered(params.threshold);
    let mut rows: Vec<&[f32]> = Vec::with_capacity((window.height() as i32 + 2 * r) as usize);
    for y in window.y0 - r..window.y1 + r {
        let at = view.offset(window.x0, y);
        rows.push(&data[at..at + len]);
    }
    for (y, rows) in (window.y0..window.y1).zip(rows.windows(2 * r as usize + 1)) {
        for (n, target) in band.row_mut(0, y).chunks_mut(RUN / 4).enumerate() {
            // Lanes past the end of a row go through the same arithmetic and are not kept.
            let mut sums = [0.0; RUN];
            sum(
                simd,
                r as usize,
                #[inline(always)]
                |i| f32x16::from_slice(simd, &weights[i]),
                #[inline(always)]
                |i| &rows[i][RUN * n..],
                &mut sums[..4 * target.len()],
            );
            let mut at = 0;
            while at < target.len() {
                let len = BLOCK.min(target.len() - at);
                let pixels = read(simd, &sums[4 * at..4 * (at + BLOCK)]);
                write([edge(simd, params, uncovered, pixels)], &mut target[at..at + len]);
                at += BLOCK;
            }
        }
    }
}

/// The edge image of (narrow L, narrow alpha, wide L, wide alpha), `uncovered` where nothing is.
#[inline(always)]
fn edge<S: Simd>(simd: S, params: &Params, uncovered: f32, [nl, na, wl, wa]: [f32x8<S>; 4]) -> f32x8<S> {
    let (u, covered) = dog_of_sums([nl, na], [wl, wa], params.base, params.edge);
    let line = edge_of_response(u, params.threshold, params.epsilon, params.phi, params.faintness);
    covered.select(line, f32x8::splat(simd, uncovered))
}
