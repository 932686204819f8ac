//! One step of mean curvature flow (6.1) and of its constrained variant (6.2), by harmonic averaging
//! (Didas and Weickert 2007): a pixel moves towards its four neighbours by the shares
//! 2 |grad u|_i / (|grad u|_i + |grad u|_j). All channels have the gradient of the colour (§ 2.2.4).
//!
//! The share of a neighbour can reach 2, so that explicit steps above 1/8 could overshoot at single
//! pixels; such pixels go to the mean of their neighbours and no further, and the maximum principle
//! holds for every time step.
//!
//! Cost: 100 operations; 140 with the constraint. Memory takes longer than these: rows are read once
//! and gradients kept in rings. The shader reads them through workgroup memory, 4 loads a pixel.

pub use crate::kernels::shaders::mean_curvature_flow::Params;
use crate::kernels::shared::coverage::premultiply;
use crate::kernels::shared::tensor::tangent;
use crate::kernels::simd::line_buffer::{LineBuffer, pixels, strips};
use crate::kernels::simd::pixels::{Block, eight, write};
use isophote_engine::fearless_simd::prelude::*;
use isophote_engine::fearless_simd::{Simd, dispatch, f32x8};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(mean_curvature_flow {
    cpu: run,
    cost: |p| if p.constraint > 0.0 { 140.0 } else { 100.0 },
    tolerance: Tolerance {
        absolute: 2e-6,
        relative: 1e-5,
        outliers: 0.001,
        reason: "ratios of gradients, which magnify the last bits of the colours where these are bright \
                 and alike",
    },
});

/// A step by `time_step`; with `constraint` (r of 6.2, 0..=1) slower where isophotes do not follow the
/// orientation of the tensors.
pub fn pass(
    plan: &mut PlanBuilder,
    color: ImageId,
    tensors: Option<ImageId>,
    time_step: f32,
    constraint: f32,
) -> ImageId {
    let constraint = if tensors.is_some() { constraint } else { 0.0 };
    // Where no tensor is read, any image may stand in its place.
    let inputs = [color, tensors.unwrap_or(color)];
    plan.pass(&KERNEL, &inputs, &Params { time_step, constraint }, Class::Colour, Support::Pixels(2))
}

/// Squared gradient below which a pixel counts as flat: a thousandth of white per pixel. The flow is
/// plain diffusion there.
const EPSILON2: f32 = 1e-6;

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    if params.constraint > 0.0 {
        dispatch!(pass.level, simd => moved::<_, true>(simd, pass, &params, band));
    } else {
        dispatch!(pass.level, simd => moved::<_, false>(simd, pass, &params, band));
    }
}

/// Gradient magnitudes of three rows, indexed as the rows they are of.
#[derive(Default)]
struct Magnitudes {
    len: usize,
    data: Vec<f32>,
}

impl Magnitudes {
    #[inline(always)]
    fn row(&self, y: i32) -> &[f32] {
        &self.data[y.rem_euclid(3) as usize * self.len..][..self.len]
    }

    #[inline(always)]
    fn compute<S: Simd>(&mut self, simd: S, rows: &LineBuffer, y: i32) {
        let target = &mut self.data[y.rem_euclid(3) as usize * self.len..][..self.len];
        let around = Around::new(rows, y);
        // The last block overlaps the one before it: the row need not be a multiple of eight.
        let last = self.len - 9;
        let mut at = 1;
        loop {
            let [x, y] = around.gradient(simd, at);
            magnitude(simd, &x, &y).store_slice(&mut target[at..at + 8]);
            if at == last {
                break;
            }
            at = (at + 8).min(last);
        }
    }
}

#[inline(always)]
fn magnitude<S: Simd>(simd: S, x: &[f32x8<S>; 3], y: &[f32x8<S>; 3]) -> f32x8<S> {
    (squared(x) + squared(y) + f32x8::splat(simd, EPSILON2)).sqrt()
}

#[inline(always)]
fn squared<S: Simd>(v: &[f32x8<S>; 3]) -> f32x8<S> {
    v[2].mul_add(v[2], v[1].mul_add(v[1], v[0] * v[0]))
}

/// The rows around one row, channel by channel; colours multiplied by their coverage.
struct Around<'a> {
    above: [&'a [f32]; 4],
    centre: [&'a [f32]; 4],
    below: [&'a [f32]; 4],
}

impl<'a> Around<'a> {
    #[inline(always)]
    fn new(rows: &'a LineBuffer, y: i32) -> Self {
        Self { above: rows.channels(y - 1), centre: rows.channels(y), below: rows.channels(y + 1) }
    }

    /// Central differences of the colour times its squared coverage.
    #[inline(always)]
    fn gradient<S: Simd>(&self, simd: S, at: usize) -> [[f32x8<S>; 3]; 2] {
        let zero = f32x8::splat(simd, 0.0);
        let centre = pixels(simd, &self.centre, at);
        let (left, right) = (pixels(simd, &self.centre, at - 1), pixels(simd, &self.centre, at + 1));
        let (above, below) = (pixels(simd, &self.above, at), pixels(simd, &self.below, at));
        let (mut x, mut y) = ([zero; 3], [zero; 3]);
        let (across, down) = (right[3] - left[3], below[3] - above[3]);
        for c in 0..3 {
            x[c] = (centre[3] * (right[c] - left[c]) - centre[c] * across) * 0.5;
            y[c] = (centre[3] * (below[c] - above[c]) - centre[c] * down) * 0.5;
        }
        [x, y]
    }
}

#[inline(always)]
fn moved<S: Simd, const CONSTRAINED: bool>(
    simd: S,
    pass: &CpuPass<'_>,
    params: &Params,
    band: &mut Band<'_>,
) {
    let window = band.window;
    let view = &pass.inputs[0];
    let mut rows = LineBuffer::default();
    let mut magnitudes = Magnitudes::default();
    for (x0, x1) in strips(window.x0, window.x1) {
        rows.start(x0, x1, 2, 4);
        magnitudes.len = rows.stride();
        magnitudes.data.resize(3 * magnitudes.len, 0.0);
        for y in window.y0 - 2..=window.y0 {
            rows.load_mapped(simd, view, y, premultiply);
        }
        magnitudes.compute(simd, &rows, window.y0 - 1);
        rows.load_mapped(simd, view, window.y0 + 1, premultiply);
        magnitudes.compute(simd, &rows, window.y0);
        for y in window.y0..window.y1 {
            rows.load_mapped(simd, view, y + 2, premultiply);
            magnitudes.compute(simd, &rows, y + 1);
            let around = Around::new(&rows, y);
            let own = [magnitudes.row(y - 1), magnitudes.row(y), magnitudes.row(y + 1)];
            let target =
                &mut band.row_mut(0, y)[4 * (x0 - window.x0) as usize..4 * (x1 - window.x0) as usize];
            for (i, target) in target.chunks_mut(32).enumerate() {
                let at = 8 * i + 2;
                let place = Block::until(x1, x0 + 8 * i as i32, y);
                let speed = if CONSTRAINED {
                    let tensor = place.read(simd, &pass.inputs[1]);
                    aligned(&tensor, &around.gradient(simd, at), params)
                } else {
                    f32x8::splat(simd, params.time_step)
                };
                let origin = place.read(simd, view);
                write(block(simd, &around, &own, &origin, speed, at), target);
            }
        }
    }
}

/// The time step, slowed down where isophotes do not follow the tangents (6.2).
#[inline(always)]
fn aligned<S: Simd>(tensor: &[f32x8<S>; 4], [x, y]: &[[f32x8<S>; 3]; 2], params: &Params) -> f32x8<S> {
    let [tx, ty] = tangent(tensor[0], tensor[1], tensor[2]);
    let across = [x[0] * ty - y[0] * tx, x[1] * ty - y[1] * tx, x[2] * ty - y[2] * tx];
    let share = ((squared(&across) + EPSILON2) / (squared(x) + squared(y) + EPSILON2)).sqrt();
    ((share - 1.0) * params.constraint + 1.0) * params.time_step
}

/// Eight pixels after a step.
#[inline(always)]
fn block<S: Simd>(
    simd: S,
    around: &Around<'_>,
    magnitudes: &[&[f32]; 3],
    origin: &[f32x8<S>; 4],
    speed: f32x8<S>,
    at: usize,
) -> [f32x8<S>; 4] {
    let one = f32x8::splat(simd, 1.0);
    let own = eight(simd, magnitudes[1], at);
    let left = own + f32x8::from_slice(simd, &magnitudes[1][at - 1..at + 7]);
    let right = own + f32x8::from_slice(simd, &magnitudes[1][at + 1..at + 9]);
    let above = own + eight(simd, magnitudes[0], at);
    let below = own + eight(simd, magnitudes[2], at);
    // One division for two quotients.
    let double = own + own;
    let across = double / (left * right);
    let down = double / (above * below);
    let shares = [right * across, left * across, below * down, above * down];
    let neighbours = [
        pixels(simd, &around.centre, at - 1),
        pixels(simd, &around.centre, at + 1),
        pixels(simd, &around.above, at),
        pixels(simd, &around.below, at),
    ];
    let zero = f32x8::splat(simd, 0.0);
    let mut sum = [zero; 4];
    for i in 0..4 {
        let (share, v) = (shares[i], &neighbours[i]);
        for c in 0..3 {
            sum[c] = share.mul_add(v[c] - origin[c] * v[3], sum[c]);
        }
        sum[3] = share.mul_add(v[3], sum[3]);
    }
    // Never beyond the mean of the neighbours.
    let speed = speed.at_most(one / sum[3].at_least(f32x8::splat(simd, 1e-6)));
    [
        speed.mul_add(sum[0], origin[0]),
        speed.mul_add(sum[1], origin[1]),
        speed.mul_add(sum[2], origin[2]),
        origin[3],
    ]
}
