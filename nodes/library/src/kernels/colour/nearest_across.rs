//! Depth of the nearest point among those beside a pixel in its row, and by how many columns it lies to the right.
//!
//! Cost: 2 reach + 1 reads per pixel.

pub use crate::kernels::shaders::nearest_across::Params;
use crate::kernels::shared::breaks::depths;
use isophote_engine::fearless_simd::{Simd, f32x8, i32x8, prelude::*};
use isophote_engine::{Class, ImageId, PlanBuilder, Support, Tolerance, View};

crate::kernel!(nearest_across {
    block: |simd, pass, params| |block| {
        nearest(&pass.inputs[0], params.reach as i32, [block.columns(simd), i32x8::splat(simd, block.y)])
    },
    cost: |p| f64::from(2 * p.reach + 1) * 8.0,
    tolerance: Tolerance::of_rounding(0.0, 0.0, "numbers are compared, and copied"),
});

/// Depth of what is not there.
pub const FAR: f32 = 3e38;

/// Depth and columns, within `reach` of a pixel.
pub fn pass(plan: &mut PlanBuilder, depth: ImageId, reach: u32) -> ImageId {
    let params = Params { reach };
    plan.pass(&KERNEL, &[depth], &params, Class::Field, Support::Pixels(reach))
}

/// Depth, [`FAR`] where there is nothing.
#[inline(always)]
pub fn known<S: Simd>(view: &View<'_>, [x, y]: [i32x8<S>; 2]) -> f32x8<S> {
    let z = depths(x.simd, view, [x, y]);
    z.simd_gt(0.0).select(z, f32x8::splat(x.simd, FAR))
}

#[inline(always)]
fn nearest<S: Simd>(depth: &View<'_>, reach: i32, [x, y]: [i32x8<S>; 2]) -> [f32x8<S>; 2] {
    let mut nearest = [known(depth, [x, y]), f32x8::splat(x.simd, 0.0)];
    for by in 1..=reach {
        for side in [-by, by] {
            let z = known(depth, [x + side, y]);
            let is_nearer = z.simd_lt(nearest[0]);
            nearest = [
                is_nearer.select(z, nearest[0]),
                is_nearer.select(f32x8::splat(x.simd, side as f32), nearest[1]),
            ];
        }
    }
    nearest
}
