//! Nearness of what stands in front, at pixels just behind where depth jumps, so that a dilation tells what stands in front
//! within some distance.
//!
//! Cost: 16 reads and about 100 operations per pixel.

use crate::kernels::shared::breaks::{APART, depth_apart, depths, nearness};
use crate::kernels::simd::pixels::{for_blocks, write};
use isophote_engine::fearless_simd::{Simd, f32x8, i32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance, View};

crate::kernel!(occluders {
    cpu: |simd, pass, band| nearest(simd, pass, band),
    cost: |_| 180.0,
    tolerance: Tolerance {
        absolute: 1e-6,
        relative: 1e-6,
        outliers: 1e-3,
        reason: "surfaces that are just so far apart touch or do not",
    },
});

/// Pixels around one that jumps are found by.
const REACH: u32 = 5;

/// Pixels beside a jump at which what is in front is known.
pub const BAND: f32 = 3.0;

/// (1/z, 1/z, 1/z, 1) of the nearest thing in front of a pixel beside it, and (0, 0, 0, 1) elsewhere.
pub fn pass(plan: &mut PlanBuilder, depth: ImageId) -> ImageId {
    plan.pass(&KERNEL, &[depth], &(), Class::Field, Support::Pixels(REACH))
}

#[inline(always)]
fn nearest<S: Simd>(simd: S, pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let depth = &pass.inputs[0];
    for_blocks::<4>(
        band,
        #[inline(always)]
        |block, target| {
            let at = [block.columns(simd), i32x8::splat(simd, block.y)];
            let mut nearest = f32x8::splat(simd, 0.0);
            for step in [[1, 0], [-1, 0], [0, 1], [0, -1]] {
                nearest = nearest.at_least(in_front(simd, depth, at, step));
            }
            write([nearest, nearest, nearest, f32x8::splat(simd, 1.0)], target);
        },
    );
}

/// Nearness of what is in front of pixels within three steps from them, 0 where nothing is.
#[inline(always)]
fn in_front<S: Simd>(simd: S, depth: &View<'_>, [x, y]: [i32x8<S>; 2], [right, down]: [i32; 2]) -> f32x8<S> {
    let mut nearnesses = [f32x8::splat(simd, 0.0); 4];
    for (value, at) in nearnesses.iter_mut().zip([-2, 0, 3, 5]) {
        *value = nearness(depths(simd, depth, [x + at * right, y + at * down]));
    }
    let [_, here, there, _] = nearnesses;
    let is_in_front = depth_apart(nearnesses).simd_ge(APART) & there.simd_gt(here);
    is_in_front.select(there, f32x8::splat(simd, 0.0))
}
