//! Lines that run out into a point, as the stroke of a pen does: narrower towards their ends, where less of them lies along the
//! flow than around their middle. The thesis has one width.
//!
//! Cost: two divisions and 15 multiply-adds per pixel.

use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Class, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(line_taper {
    block: |simd, pass| |block| {
        let [edge] = block.read(simd, &pass.inputs[0]);
        let [soft, along, darkest] = [1, 2, 3].map(
            #[inline(always)]
            |i: usize| {
                let [value, ..]: [f32x8<_>; 4] = block.read(simd, &pass.inputs[i]);
                value
            },
        );
        tapered(edge, [soft, along, darkest])
    },
    cost: |_| 30.0,
    tolerance: Tolerance {
        absolute: 1e-3,
        relative: 1e-4,
        outliers: 1e-3,
        reason: "the division by the share of a faint line, and the steepness of its new borders, magnify rounding",
    },
    fast: Tolerance {
        absolute: 6e-2,
        relative: 1e-2,
        outliers: 1e-2,
        reason: "shares as 16-bit floats, by whose quotients borders are found",
    },
});

/// Share of a line below which nothing is known of it.
const LEAST_SHARE: f32 = 0.05;

/// Lines (1 = paper, 0 = line) that end in points; images of them, and in first channels the same smoothed in all directions,
/// and of that the mean along the flow and the least within half of a line's width.
pub fn pass(plan: &mut PlanBuilder, images: [ImageId; 4]) -> ImageId {
    plan.pass(&KERNEL, &images, &(), Class::Field, Support::Pixels(0))
}

#[inline(always)]
fn tapered<S: Simd>(edge: f32x8<S>, [soft, along, darkest]: [f32x8<S>; 3]) -> [f32x8<S>; 1] {
    let one = f32x8::splat(edge.simd, 1.0);
    let line = one - edge.within(0.0, 1.0);
    // A half of the line lies along the flow at its end, and nearly all of it within.
    let left = (one - along) / (one - soft).at_least(LEAST_SHARE);
    let inside = ((left - 0.5) * 2.857).within(0.0, 1.0);
    // 1 on the middle of the line, and about two thirds at its borders.
    let height = (one - soft) / (one - darkest).at_least(LEAST_SHARE);
    let border = (one - inside) * 1.02 + inside * 0.6;
    let narrow = ((height - border) * 12.0).within(0.0, 1.0);
    let whole = ((inside - 0.8) * 5.0).within(0.0, 1.0);
    let kept = narrow + (one - narrow) * whole;
    [one - line * kept]
}
