//! The edge image of a response, averaged over an area around each pixel, so that lines keep their coverage while they
//! move by parts of a pixel. The more of neighbouring frames counts at a pixel the wider the area is; where the
//! frame stands alone or nothing moves it is a point, and the result that of the threshold by itself (4.6, 4.8).
//!
//! Cost: nine reads and up to 16 exponentials per pixel; few where neither line nor paper is in doubt.

pub use crate::kernels::shaders::edge_area::Params;
use crate::kernels::shared::edge_threshold::{NOT_COVERED, Xdog, edge_threshold, fainter};
use crate::kernels::simd::around::rows;
use crate::kernels::simd::pixels::{BLOCK, Block, read, write};
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(edge_area {
    cpu: |simd, pass, params, band| areas(simd, pass, &params, band),
    cost: |_| 250.0,
    tolerance: Tolerance {
        absolute: 2e-3,
        relative: 1e-4,
        outliers: 2e-3,
        reason: "the slope of the threshold magnifies the rounding of samples; a binary one decides by the last bit",
    },
});

/// Side of the area where all frames count, pixels: wide enough that lines fade from pixel to pixel.
const WIDTH: f32 = 2.0;
/// Amount by which a response is sharpened there, which gives lines back what averages take from their darkness.
const SHARPENING: f32 = 1.0;
/// Motion from which on lines count as moving, pixels per frame.
const MOVING: f32 = 0.25;

/// Shares by which frames count.
#[derive(Clone, Copy, Debug)]
pub struct Shares {
    /// Shares and sums of weights ([`carried_share`](crate::kernels::time::carried_share)).
    pub image: ImageId,
    /// Motion to the nearest other frame.
    pub motion: ImageId,
    /// Sum of the weights of all other frames where they count in full; above 0.
    pub most: f32,
}

/// The edge image of a response, in units of L, thresholded as `xdog` says.
pub fn pass(plan: &mut PlanBuilder, response: ImageId, shares: Shares, xdog: &Xdog) -> ImageId {
    let params = Params {
        width: WIDTH,
        sharpening: SHARPENING,
        inverse_most: 1.0 / shares.most,
        inverse_moving: 1.0 / MOVING,
        threshold: xdog.threshold as u32,
        epsilon: xdog.epsilon,
        phi: xdog.phi,
        faintness: xdog.faintness,
    };
    plan.pass(&KERNEL, &[response, shares.image, shares.motion], &params, Class::Field, Support::Pixels(1))
}

#[inline(always)]
fn areas<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, band: &mut Band<'_>) {
    let window = band.window;
    let mut scratch: [Vec<f32>; 3] = Default::default();
    for y in window.y0..window.y1 {
        let rows = rows(&pass.inputs[0], y, window, &mut scratch);
        let row = band.row_mut(0, y);
        for x in (window.x0..window.x1).step_by(BLOCK) {
            let block = Block::until(window.x1, x, y);
            let at = (x - window.x0) as usize;
            let own = value(simd, rows[1], at + 1, &block);
            let around = [
                beside(simd, rows[0], at, &block, own),
                beside(simd, rows[1], at, &block, own),
                beside(simd, rows[2], at, &block, own),
            ];
            let [_, total]: [f32x8<S>; 2] = block.read(simd, &pass.inputs[1]);
            let [u, v]: [f32x8<S>; 2] = block.read(simd, &pass.inputs[2]);
            let speed = (u.mul_add(u, v * v).sqrt() * params.inverse_moving).at_most(1.0);
            let share = ((total - 1.0) * params.inverse_most).within(0.0, 1.0) * speed;
            write([fainter(area(params, around, share), params.faintness)], &mut row[at..at + block.len]);
        }
    }
}

/// Eight responses of a row from `at` on.
#[inline(always)]
fn value<S: Simd>(simd: S, row: &[f32], at: usize, block: &Block) -> f32x8<S> {
    let [value] = read(simd, &row[at..at + block.len]);
    value
}

/// The same with those before and behind; `own` where nothing is covered.
#[inline(always)]
fn beside<S: Simd>(simd: S, row: &[f32], at: usize, block: &Block, own: f32x8<S>) -> [f32x8<S>; 3] {
    // One by one: what maps arrays stays a call in code for wide vectors.
    let mut values = [own; 3];
    for (column, beside) in values.iter_mut().enumerate() {
        let value = value(simd, row, at + column, block);
        *beside = value.simd_ge(NOT_COVERED).select(own, value);
    }
    values
}

/// The result for pixels with what surrounds them, and how far other frames count.
#[inline(always)]
fn area<S: Simd>(params: &Params, rows: [[f32x8<S>; 3]; 3], share: f32x8<S>) -> f32x8<S> {
    let own = rows[1][1];
    let alone = edge_threshold(own, params.threshold, params.epsilon, params.phi);
    let counts = share.simd_gt(0.0);
    if !counts.any_true() {
        return alone;
    }
    let around = ((rows[0][1] + rows[2][1]) + (rows[1][0] + rows[1][2])) * 0.25;
    let sharper = share * params.sharpening * (own - around);
    // The outermost of four samples that divide the area evenly.
    let reach = share * (0.375 * params.width);
    let (top, middle, bottom) = (samples(rows[0], reach), samples(rows[1], reach), samples(rows[2], reach));
    let mut sum = f32x8::splat(own.simd, 0.0);
    for i in 0..4 {
        for value in samples([top[i], middle[i], bottom[i]], reach) {
            sum += edge_threshold(value + sharper, params.threshold, params.epsilon, params.phi);
        }
    }
    counts.select(sum * (1.0 / 16.0), alone)
}

/// Four samples across a pixel, from the values before, at and behind it; `reach` is the outermost.
#[inline(always)]
fn samples<S: Simd>([before, own, behind]: [f32x8<S>; 3], reach: f32x8<S>) -> [f32x8<S>; 4] {
    let (before, behind) = ((before - own) * reach, (behind - own) * reach);
    let third = 1.0 / 3.0;
    [own + before, before * third + own, behind * third + own, own + behind]
}
