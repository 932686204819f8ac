//! Bristle marks and shine of paint on a Lab image, from a field of heights that follows the strokes:
//! noise smoothed along the tensor (§ 1.2). Adding it after the smoothing is the same as adding noise
//! before it, and lets colour and marks be smoothed over different lengths.
//!
//! Cost: 25 multiply-adds.

pub use crate::kernels::shaders::paint_relief::Params;
use crate::kernels::simd::line_buffer::{Rows, strips};
use crate::kernels::simd::pixels::{get_pixels4, put_pixels4};
use isophote_engine::fearless_simd::{Simd, dispatch, f32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(paint_relief {
    cpu: run,
    cost: |_| 25.0,
    tolerance: Tolerance { absolute: 1e-3, relative: 1e-5, outliers: 0.0, reason: "a dozen roundings of L" },
});

/// What the paint looks like.
#[derive(Clone, Copy, Debug)]
pub struct Relief {
    /// Units of L, on white, per unit of height.
    pub bristle: f32,
    /// Units of L, on white, per unit of height per pixel.
    pub shine: f32,
    /// Where the light comes from, degrees counter-clockwise from the right.
    pub angle: f32,
}

/// Lights `lab` by `heights`, whose first channel is 0..=1.
pub fn lit(plan: &mut PlanBuilder, lab: ImageId, heights: ImageId, relief: &Relief) -> ImageId {
    let (sin, cos) = relief.angle.to_radians().sin_cos();
    // y points down.
    let light = [relief.shine * cos, -relief.shine * sin];
    let params = Params { light, bristle: relief.bristle, padding: Default::default() };
    plan.pass(&KERNEL, &[lab, heights], &params, Class::Colour, Support::Pixels(1))
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    dispatch!(pass.level, simd => relief(simd, pass, &params, band));
}

#[inline(always)]
fn relief<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, band: &mut Band<'_>) {
    let window = band.window;
    let mut rows = Rows::default();
    for (x0, x1) in strips(window.x0, window.x1) {
        rows.start(x0, x1, 1, 4);
        for y in window.y0 - 1..=window.y0 {
            rows.load4(
                simd,
                &pass.inputs[1],
                y,
                #[inline(always)]
                |v| v,
            );
        }
        for y in window.y0..window.y1 {
            rows.load4(
                simd,
                &pass.inputs[1],
                y + 1,
                #[inline(always)]
                |v| v,
            );
            let (above, centre, below) = (rows.row(y - 1, 0), rows.row(y, 0), rows.row(y + 1, 0));
            let target =
                &mut band.row_mut(0, y)[4 * (x0 - window.x0) as usize..4 * (x1 - window.x0) as usize];
            for (i, target) in target.chunks_mut(32).enumerate() {
                let at = 8 * i + 1;
                let of = |row: &[f32], at: usize| f32x8::from_slice(simd, &row[at..at + 8]);
                let dx = (of(centre, at + 1) - of(centre, at - 1)) * 0.5;
                let dy = (of(below, at) - of(above, at)) * 0.5;
                let lift =
                    (of(centre, at) - 0.5) * params.bristle - (dx * params.light[0] + dy * params.light[1]);
                let [l, a, b, alpha] = get_pixels4(simd, &pass.inputs[0], x0 + 8 * i as i32, y, x1 - 1);
                let share = (l.max(0.0) + 16.0) / 116.0;
                put_pixels4([l + share * lift, a, b, alpha], target);
            }
        }
    }
}
