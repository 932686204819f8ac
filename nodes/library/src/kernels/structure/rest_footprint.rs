//! Footprint of a pixel on an object: the distance by which the point of the undeformed object changes from pixel to
//! pixel of the same surface. Marks on objects keep their size on screen by it.
//!
//! Let J be the 3 x 2 matrix of the point's derivatives by pixels and a >= b its singular values, the square roots of
//! the eigenvalues of the first fundamental form J^T J. A pixel covers a b of the surface, so that sqrt(a b) is the
//! mean width of its footprint: marks on inclined surfaces keep their area. Beyond an inclination of 4 : 1 it is a / 2,
//! or marks would be too narrow for the pixels across them.
//!
//! Cost: five loads and about 60 operations.

use crate::kernels::shared::rest_position::{NO_FOOTPRINT, is_at_rest};
use crate::kernels::simd::pixels::{Block, pixels_beside};
use isophote_engine::fearless_simd::{Simd, f32x8, mask32x8, prelude::*};
use isophote_engine::math::Elementary;
use isophote_engine::{Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};
use std::f32::consts::LOG2_E;

crate::kernel!(rest_footprint {
    block: |simd, pass| |block| footprint(simd, pass, block),
    cost: |_| 90.0,
    tolerance: Tolerance {
        absolute: 1e-3,
        relative: 0.0,
        outliers: 2e-3,
        reason: "the rounding of a difference of points against its length, and of two sides with almost the same \
                 change the last bit decides which holds",
    },
});

/// Logarithms, to base 2, of the mean width of a pixel on the object and of its longest, in the units of `points`; both
/// [`NO_FOOTPRINT`] where there is no object or no neighbour on it.
pub fn pass(plan: &mut PlanBuilder, points: ImageId) -> ImageId {
    plan.pass(&KERNEL, &[points], &(), Class::Field, Support::Pixels(1))
}

/// Change of the points per pixel along an axis, and where it is known.
#[derive(Clone, Copy)]
struct Change<S: Simd> {
    by: [f32x8<S>; 3],
    is_known: mask32x8<S>,
}

impl<S: Simd> Change<S> {
    #[inline(always)]
    fn dot(&self, other: &Self) -> f32x8<S> {
        self.by[2].mul_add(other.by[2], self.by[1].mul_add(other.by[1], self.by[0] * other.by[0]))
    }
}

/// Across a silhouette another object lies beside, so that of both sides the one with less change holds.
#[inline(always)]
fn change<S: Simd>(
    simd: S,
    pass: &CpuPass<'_>,
    block: Block,
    here: [f32x8<S>; 4],
    [dx, dy]: [i32; 2],
) -> Change<S> {
    let points = &pass.inputs[0];
    let [width, height] = points.full();
    let columns = block.columns(simd);
    let rows_before = block.y - dy >= 0;
    let rows_after = block.y + dy < height;
    let mut sides = [Change { by: [f32x8::splat(simd, 0.0); 3], is_known: columns.simd_lt(0) }; 2];
    for side in 0..2 {
        let sign = 2 * side as i32 - 1;
        let there = pixels_beside(simd, points, block, [sign * dx, sign * dy]);
        let in_rows = if side == 0 { rows_before } else { rows_after };
        let inside = if side == 0 { columns.simd_ge(dx) } else { columns.simd_lt(width - dx) };
        let is_known = is_at_rest(there) & if in_rows { inside } else { columns.simd_lt(0) };
        let zero = f32x8::splat(simd, 0.0);
        for c in 0..3 {
            let difference = if side == 0 { here[c] - there[c] } else { there[c] - here[c] };
            sides[side].by[c] = is_known.select(difference, zero);
        }
        sides[side].is_known = is_known;
    }
    let [back, ahead] = sides;
    let is_less = ahead.dot(&ahead).simd_lt(back.dot(&back));
    let takes_ahead = ahead.is_known & (is_less | !back.is_known);
    let mut by = back.by;
    for c in 0..3 {
        by[c] = takes_ahead.select(ahead.by[c], back.by[c]);
    }
    Change { by, is_known: back.is_known | ahead.is_known }
}

#[inline(always)]
fn footprint<S: Simd>(simd: S, pass: &CpuPass<'_>, block: Block) -> [f32x8<S>; 2] {
    let here = block.read(simd, &pass.inputs[0]);
    let x = change(simd, pass, block, here, [1, 0]);
    let y = change(simd, pass, block, here, [0, 1]);
    let (xx, yy, zero) = (x.dot(&x), y.dot(&y), f32x8::splat(simd, 0.0));
    // The first fundamental form (E, F, G), relative to its trace.
    let (e, g) = (x.is_known.select(xx, yy), y.is_known.select(yy, xx));
    let trace = e + g;
    let is_known = is_at_rest(here) & trace.simd_gt(1e-30);
    let divisor = is_known.select(trace, f32x8::splat(simd, 1.0));
    let f = (x.is_known & y.is_known).select(x.dot(&y), zero) / divisor;
    let area = ((e / divisor) * (g / divisor) - f * f).at_least(zero).sqrt();
    let half = (e - g) / divisor * 0.5;
    let longest = (half * half + f * f).sqrt() + 0.5;
    let mean = area.at_least(longest * 0.25);
    let none = f32x8::splat(simd, NO_FOOTPRINT);
    let halved = 0.5 * LOG2_E;
    [
        is_known.select((divisor * mean).ln() * halved, none),
        is_known.select((divisor * longest).ln() * halved, none),
    ]
}
