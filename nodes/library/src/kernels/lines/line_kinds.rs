//! Kinds of lines that geometry draws, as technical illustrators and inkers tell them apart: creases, outlines, and borders
//! between things that touch. The thesis has one kind.
//!
//! Cost: 33 reads and about 200 operations per pixel.

pub use crate::kernels::shaders::line_kinds::Params;
use crate::kernels::shared::breaks::{APART, depth_apart, depths, ids, nearness, normal_break, normals};
use crate::kernels::simd::pixels::{for_blocks, write};
use isophote_engine::fearless_simd::{Simd, f32x8, i32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(line_kinds {
    cpu: |simd, pass, params, band| kinds(simd, pass, &params, band),
    cost: |_| 400.0,
    tolerance: Tolerance {
        absolute: 1e-4,
        relative: 1e-4,
        outliers: 1e-3,
        reason: "ramps of angles and depths magnify their rounding; surfaces that are just so far apart touch or do not",
    },
});

/// Pixels around one that breaks are found by.
const REACH: u32 = 4;

/// Densities (crease, outline, border, 0), 1 at pixels that have a break to one of their four neighbours; guides are normal,
/// depth and object id, as far as there are any.
pub fn pass(plan: &mut PlanBuilder, guides: [Option<ImageId>; 3]) -> Option<ImageId> {
    let any = guides.into_iter().flatten().next()?;
    let params = Params { guides: (0..3).map(|i| u32::from(guides[i].is_some()) << i).sum() };
    // A guide that is not there is not read; any image may stand in for it.
    let inputs = guides.map(|guide| guide.unwrap_or(any));
    Some(plan.pass(&KERNEL, &inputs, &params, Class::Field, Support::Pixels(REACH)))
}

/// A pixel of each lane.
type Place<S> = [i32x8<S>; 2];

#[inline(always)]
fn kinds<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, band: &mut Band<'_>) {
    for_blocks::<4>(
        band,
        #[inline(always)]
        |block, target| {
            let at = [block.columns(simd), i32x8::splat(simd, block.y)];
            let mut found = [f32x8::splat(simd, 0.0); 3];
            for step in [[1, 0], [-1, 0], [0, 1], [0, -1]] {
                let one = breaks(simd, pass, params, at, step);
                for kind in 0..3 {
                    found[kind] = found[kind].at_least(one[kind]);
                }
            }
            let [crease, outline, border] = found;
            write([crease, outline, border, f32x8::splat(simd, 0.0)], target);
        },
    );
}

/// Breaks (crease, outline, border) between pixels and those at a step from them.
#[inline(always)]
fn breaks<S: Simd>(
    simd: S,
    pass: &CpuPass<'_>,
    params: &Params,
    [x, y]: Place<S>,
    [right, down]: [i32; 2],
) -> [f32x8<S>; 3] {
    let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
    let [normal, depth, object_id] = pass.inputs else { return [zero; 3] };
    let has = |bit: u32| params.guides & bit != 0;
    let (here, next) = ([x, y], [x + right, y + down]);
    let (mut crease, mut outline, mut border) = (zero, zero, zero);
    if has(1) {
        [crease, outline] = normal_break(normals(simd, normal, here), normals(simd, normal, next));
    }
    let mut apart = zero;
    if has(2) {
        let mut nearnesses = [zero; 4];
        for (value, at) in nearnesses.iter_mut().zip([-3, -1, 2, 4]) {
            *value = nearness(depths(simd, depth, [x + at * right, y + at * down]));
        }
        apart = depth_apart(nearnesses).simd_ge(APART).select(one, zero);
        outline = outline.at_least(apart);
    }
    if has(4) {
        let is_same = ids(simd, object_id, here).simd_eq(ids(simd, object_id, next));
        let differs = is_same.select(zero, one);
        // What touches what is known by depth.
        let touches = if has(2) { differs * (one - apart) } else { zero };
        crease *= one - differs;
        outline = outline.at_least(differs - touches);
        border = touches;
    }
    [crease, outline, border]
}
