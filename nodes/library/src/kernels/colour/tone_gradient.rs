//! Gradient of the L of a Lab image by the Sobel operator (2.23), in the first two of four channels, so that the kernels of
//! fields can smooth it; at half the size, the mean of those of four pixels, since it is smoothed widely. Long ones count the less the longer they are, since an edge is no change of tone: a mean of gradients
//! then says how much the tones around change, and beside an edge flat ones stay flat. Where a neighbour is transparent it
//! stands for the centre.
//!
//! Cost: 40 operations for each of four pixels.

pub use crate::kernels::shaders::tone_gradient::Params;
use crate::kernels::simd::neighbours::{Neighbours, each};
use isophote_engine::fearless_simd::{Simd, dispatch, f32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Rect, Support, Tolerance, View};

crate::kernel!(tone_gradient {
    cpu: run,
    cost: |_| 160.0,
    tolerance: Tolerance {
        absolute: 1e-3,
        relative: 1e-4,
        outliers: 0.002,
        reason: "differences magnify the last bits of lightness, and those of broken pictures are a thousand times as large",
    },
});

/// The gradient, units of L per pixel of the image, one level up; one that is n times as long as `longest` has an nth of
/// that length.
pub fn pass(plan: &mut PlanBuilder, lab: ImageId, longest: f32) -> ImageId {
    let level = plan.desc(lab).level + 1;
    plan.pass_at(&KERNEL, &[lab], &Params { longest }, &[Class::Colour], Support::Pixels(1), level)
}

/// Rows of the result that are computed from gradients of pixels at once, which then are still in the cache.
const ROWS: i32 = 8;

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    let window = band.window;
    let [width, height] = pass.inputs[0].full();
    let mut gradients = Vec::new();
    let mut y = window.y0;
    while y < window.y1 {
        let rows = Rect { y0: y, y1: window.y1.min(y + ROWS), ..window };
        let children = Rect {
            x0: 2 * rows.x0,
            y0: 2 * rows.y0,
            x1: width.min(2 * rows.x1),
            y1: height.min(2 * rows.y1),
        };
        gradients.resize(4 * children.area() as usize, 0.0);
        let mut of_pixels = Band { window: children, full: [width, height], outputs: vec![&mut gradients] };
        dispatch!(pass.level, simd => differences(simd, &params, &pass.inputs[0], &mut of_pixels));
        let stride = 4 * children.width() as usize;
        let mut pairs = gradients.chunks(2 * stride);
        for y in rows.y0..rows.y1 {
            let Some((upper, lower)) = pairs.next().and_then(|pair| pair.split_at_checked(stride)) else {
                break;
            };
            means(upper, lower, band.row_mut(0, y));
        }
        y = rows.y1;
    }
}

/// The mean of the gradients of two rows, or of the one that there is, for each pair of pixels or the last one.
fn means(upper: &[f32], lower: &[f32], target: &mut [f32]) {
    let lower = lower.chunks(8).chain(std::iter::repeat(&[][..]));
    for ((upper, lower), target) in upper.chunks(8).zip(lower).zip(target.chunks_exact_mut(4)) {
        let (mut x, mut y, mut count) = (0.0, 0.0, 0.0);
        for pixel in upper.chunks_exact(4).chain(lower.chunks_exact(4)) {
            x += pixel[0];
            y += pixel[1];
            count += 1.0f32;
        }
        target.copy_from_slice(&[x / count, y / count, 0.0, 1.0]);
    }
}

/// The gradients of single pixels, shortened.
#[inline(always)]
fn differences<S: Simd>(simd: S, params: &Params, view: &View<'_>, band: &mut Band<'_>) {
    each(
        simd,
        view,
        band,
        #[inline(always)]
        |around: Neighbours<'_, S>| {
            let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
            let (left_up, left_down) = (around.excess(-1, -1, 0), around.excess(-1, 1, 0));
            let (right_up, right_down) = (around.excess(1, -1, 0), around.excess(1, 1, 0));
            let x = (around.excess(1, 0, 0) - around.excess(-1, 0, 0)) * 0.25
                + ((right_up - left_up) + (right_down - left_down)) * 0.125;
            let y = (around.excess(0, 1, 0) - around.excess(0, -1, 0)) * 0.25
                + ((left_down - left_up) + (right_down - right_up)) * 0.125;
            let length = (x * x + y * y).sqrt().at_least(1e-6);
            let share = (one * params.longest / length).at_most(one);
            let shorter = share * share * around.centre(3);
            [x * shorter, y * shorter, zero, one]
        },
    );
}
