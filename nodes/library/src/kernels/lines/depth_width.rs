//! Widths of lines by the distance from the camera: a factor from 1 near to another one far, of the nearest thing around, to
//! which a line beside it belongs. Illustrators draw what is near with thicker lines; the thesis has one width.
//!
//! Cost: 18 reads and about 60 operations per pixel.

use crate::kernels::lines::flow_dog_gradient::{MOST, directed};
pub use crate::kernels::shaders::depth_width::Params;
use crate::kernels::simd::pixels::{fetch1, for_blocks, offsets, write};
use isophote_engine::fearless_simd::{Simd, f32x8, i32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance, View};

crate::kernel!(depth_width {
    cpu: |simd, pass, params, band| widths(simd, pass, &params, band),
    cost: |_| 150.0,
    tolerance: Tolerance::of_rounding(1e-6, 1e-5, "a few roundings of a distance"),
});

const DIAGONAL: f32 = 0.707_106_78;
/// Distance of what is nowhere.
const NOWHERE: f32 = 3.4e38;

/// (E - G, F, 0, factor) of a field (E - G, F), or of one with a factor already, which is multiplied, and of distances.
pub fn pass(plan: &mut PlanBuilder, [field, depth]: [ImageId; 2], params: &Params) -> ImageId {
    let support = Support::Pixels(pixels_away(params.radius) as u32);
    plan.pass(&KERNEL, &[field, depth], params, Class::Field, support)
}

fn pixels_away(radius: f32) -> i32 {
    radius.ceil() as i32
}

#[inline(always)]
fn widths<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, band: &mut Band<'_>) {
    let [field, depth] = pass.inputs else { return };
    for_blocks::<4>(
        band,
        #[inline(always)]
        |block, target| {
            let at = [block.columns(simd), i32x8::splat(simd, block.y)];
            let nearest = ring(simd, depth, at, params.radius);
            let nearest = nearest.at_most(ring(simd, depth, at, 0.5 * params.radius));
            let share = ((nearest - params.near) * params.inverse_range).within(0.0, 1.0);
            let ([difference, f], before) = directed(simd, &block, field, params.scaled != 0);
            let factor = (before * (share * params.change + 1.0)).within(params.least, MOST);
            write([difference, f, f32x8::splat(simd, 0.0), factor], target);
        },
    );
}

/// The nearest distances on rings of eight pixels.
#[inline(always)]
fn ring<S: Simd>(simd: S, depth: &View<'_>, [x, y]: [i32x8<S>; 2], radius: f32) -> f32x8<S> {
    let (straight, slanted) = (pixels_away(radius), pixels_away(radius * DIAGONAL));
    let nowhere = f32x8::splat(simd, NOWHERE);
    let mut nearest = nowhere;
    for i in -1..=1 {
        for j in -1..=1 {
            let reach = if i != 0 && j != 0 { slanted } else { straight };
            let z = fetch1(simd, depth, offsets(depth, x + reach * j, y + reach * i));
            let is_there = z.abs().simd_le(f32::MAX) & z.simd_gt(0.0);
            nearest = nearest.at_most(is_there.select(z, nowhere));
        }
    }
    nearest
}
