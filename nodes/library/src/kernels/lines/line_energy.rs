//! Energy of lines as a tensor: how far the response falls below its ground, across the orientation that lines have there.
//! Averages of it tell how many lines are around, how strong, and how they lie.
//!
//! Cost: a square root and a division per pixel.

pub use crate::kernels::shaders::line_energy::Params;
use crate::kernels::shared::tensor::axis;
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Class, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(line_energy {
    block: |simd, pass, params| |block| energy(
        &params,
        block.read(simd, &pass.inputs[0]),
        block.read(simd, &pass.inputs[1]),
        block.read(simd, &pass.inputs[2])
    ),
    cost: |_| 40.0,
    tolerance: Tolerance {
        absolute: 2e-5,
        relative: 1e-5,
        outliers: 2e-3,
        reason: "the difference of ground and response loses digits for the lightness of highlights",
    },
});

/// The energy of a response (u alpha, alpha) on a lightness (L alpha, alpha) with lines along `field` (E - G, F).
pub fn pass(plan: &mut PlanBuilder, images: [ImageId; 3], params: &Params) -> ImageId {
    plan.pass(&KERNEL, &images, params, Class::Field, Support::Pixels(0))
}

#[inline(always)]
fn energy<S: Simd>(
    params: &Params,
    [u, _]: [f32x8<S>; 2],
    [l, covered]: [f32x8<S>; 2],
    [difference, f]: [f32x8<S>; 2],
) -> [f32x8<S>; 4] {
    let ground = l.at_least(covered * params.least) * params.base;
    let energy = (ground - u).within(0.0, params.most);
    let (_, [x, y]) = axis(difference * 0.5, f);
    let (ex, ey) = (energy * x, energy * y);
    [ex * x, ex * y, ey * y, f32x8::splat(u.simd, 1.0)]
}
