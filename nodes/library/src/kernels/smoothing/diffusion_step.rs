//! One explicit step of tensor-driven diffusion (§ 3.1) towards the eight neighbours, by the weights of
//! `diffusion_tensor`: a neighbour counts by the mean of the weights that both ends have for its axis,
//! and by its coverage. The weights of a pixel never exceed 4 in sum, so that for time steps up to 1/4
//! every step is a weighted mean.
//!
//! Cost: 70 operations. The shader reads through workgroup memory, 5 loads a pixel.

pub use crate::kernels::shaders::diffusion_step::Params;
use crate::kernels::simd::line_buffer::{LineBuffer, strips};
use crate::kernels::simd::pixels::{eight, write};
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(diffusion_step {
    cpu: |simd, pass, params, band| diffused(simd, pass, params.time_step, band),
    cost: |_| 70.0,
    tolerance: Tolerance::of_rounding(1e-6, 2e-6, "a weighted mean of nine pixels"),
});

/// A step by `time_step`.
pub fn pass(plan: &mut PlanBuilder, color: ImageId, weights: ImageId, time_step: f32) -> ImageId {
    plan.pass(&KERNEL, &[color, weights], &Params { time_step }, Class::Colour, Support::Pixels(1))
}

#[inline(always)]
fn diffused<S: Simd>(simd: S, pass: &CpuPass<'_>, time_step: f32, band: &mut Band<'_>) {
    let window = band.window;
    let (mut colors, mut weights) = (LineBuffer::default(), LineBuffer::default());
    for (x0, x1) in strips(window.x0, window.x1) {
        colors.start(x0, x1, 1, 4);
        weights.start(x0, x1, 1, 4);
        for y in window.y0 - 1..=window.y0 {
            colors.load(simd, &pass.inputs[0], y);
            weights.load(simd, &pass.inputs[1], y);
        }
        for y in window.y0..window.y1 {
            colors.load(simd, &pass.inputs[0], y + 1);
            weights.load(simd, &pass.inputs[1], y + 1);
            let around = Around { colors: &colors, weights: &weights, y };
            let target =
                &mut band.row_mut(0, y)[4 * (x0 - window.x0) as usize..4 * (x1 - window.x0) as usize];
            for (i, target) in target.chunks_mut(32).enumerate() {
                write(around.moved(simd, 8 * i + 1, time_step), target);
            }
        }
    }
}

/// The rows around one row.
struct Around<'a> {
    colors: &'a LineBuffer,
    weights: &'a LineBuffer,
    y: i32,
}

impl Around<'_> {
    #[inline(always)]
    fn moved<S: Simd>(&self, simd: S, at: usize, time_step: f32) -> [f32x8<S>; 4] {
        let origin = self.pixels(simd, 0, at);
        let alpha = eight(simd, self.colors.row(self.y, 3), at);
        let mut sum = [f32x8::splat(simd, 0.0); 3];
        for (channel, (dx, dy)) in [(1, 0), (0, 1), (1, 1), (1, -1)].into_iter().enumerate() {
            let own = eight(simd, self.weights.row(self.y, channel), at);
            for (dy, at) in [(-dy, at - dx), (dy, at + dx)] {
                let other = eight(simd, self.weights.row(self.y + dy, channel), at);
                let covered = eight(simd, self.colors.row(self.y + dy, 3), at);
                let weight = (own + other) * 0.5 * covered;
                let v = self.pixels(simd, dy, at);
                for c in 0..3 {
                    sum[c] = weight.mul_add(v[c] - origin[c], sum[c]);
                }
            }
        }
        let time_step = f32x8::splat(simd, time_step);
        [
            time_step.mul_add(sum[0], origin[0]),
            time_step.mul_add(sum[1], origin[1]),
            time_step.mul_add(sum[2], origin[2]),
            alpha,
        ]
    }

    #[inline(always)]
    fn pixels<S: Simd>(&self, simd: S, dy: i32, at: usize) -> [f32x8<S>; 3] {
        [
            eight(simd, self.colors.row(self.y + dy, 0), at),
            eight(simd, self.colors.row(self.y + dy, 1), at),
            eight(simd, self.colors.row(self.y + dy, 2), at),
        ]
    }
}
