//! Bristle marks and shine of paint on a Lab image, from a field of heights that follows the strokes:
//! noise smoothed along the tensor (§ 1.2). Adding it after the smoothing is the same as adding noise
//! before it, and lets colour and marks be smoothed over different lengths.
//!
//! Cost: 25 multiply-adds.

pub use crate::kernels::shaders::paint_relief::Params;
use crate::kernels::simd::line_buffer::{Row, STRIP, for_rows};
use crate::kernels::simd::pixels::{BLOCK, Block, eight, write};
use isophote_engine::fearless_simd::{Simd, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(paint_relief {
    cpu: |simd, pass, params, band| relief(simd, pass, &params, band),
    cost: |_| 25.0,
    tolerance: Tolerance::of_rounding(1e-3, 1e-5, "a dozen roundings of L"),
});

/// Appearance of the paint.
#[derive(Clone, Copy, Debug)]
pub struct Relief {
    /// Units of L, on white, per unit of height.
    pub bristle: f32,
    /// Units of L, on white, per unit of height per pixel.
    pub shine: f32,
    /// Direction that the light comes from, degrees counter-clockwise from the right.
    pub angle: f32,
}

/// Lights `lab` by `heights`, whose first channel is 0..=1.
pub fn pass(plan: &mut PlanBuilder, lab: ImageId, heights: ImageId, relief: &Relief) -> ImageId {
    let (sin, cos) = relief.angle.to_radians().sin_cos();
    // y points down.
    let light = [relief.shine * cos, -relief.shine * sin];
    let params = Params { light, bristle: relief.bristle, padding: Default::default() };
    plan.pass(&KERNEL, &[lab, heights], &params, Class::Colour, Support::Pixels(1))
}

#[inline(always)]
fn relief<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, band: &mut Band<'_>) {
    for_rows::<S, 4>(
        simd,
        &pass.inputs[1],
        band,
        [STRIP, 1],
        std::convert::identity,
        #[inline(always)]
        |Row { buffer, columns: [x0, x1], y }, target| {
            let (above, centre, below) = (buffer.row(y - 1, 0), buffer.row(y, 0), buffer.row(y + 1, 0));
            for (i, target) in target.chunks_mut(4 * BLOCK).enumerate() {
                let at = BLOCK * i + 1;
                let dx = (eight(simd, centre, at + 1) - eight(simd, centre, at - 1)) * 0.5;
                let dy = (eight(simd, below, at) - eight(simd, above, at)) * 0.5;
                let lift = (eight(simd, centre, at) - 0.5) * params.bristle
                    - (dx * params.light[0] + dy * params.light[1]);
                let block = Block::until(x1, x0 + (BLOCK * i) as i32, y);
                let [l, a, b, alpha] = block.read(simd, &pass.inputs[0]);
                let share = (l.at_least(0.0) + 16.0) / 116.0;
                write([l + share * lift, a, b, alpha], target);
            }
        },
    );
}
