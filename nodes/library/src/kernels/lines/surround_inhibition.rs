//! Surround inhibition (Grigorescu, Petkov and Westenberg, *Contour detection based on nonclassical receptive field
//! inhibition*, 2003): lines yield where many lines are around, weak ones first, so that textures fall silent and single
//! structures stay. Those of the pixel's own orientation count less, since a contour must not inhibit itself; and lines that
//! stand together more closely than those around, as in an eye or a letter, excuse each other. All is in proportion to the
//! strength of the lines, so that a texture yields in any contrast.
//!
//! Cost: a square root, a division and 20 multiply-adds per pixel.

pub use crate::kernels::shaders::surround_inhibition::Params;
use crate::kernels::shared::tensor::axis;
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Class, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(surround_inhibition {
    block: |simd, pass, params| |block| inhibited(
        &params,
        [
            block.read(simd, &pass.inputs[0]),
            block.read(simd, &pass.inputs[1]),
            block.read(simd, &pass.inputs[2])
        ],
        [block.read(simd, &pass.inputs[3]), block.read(simd, &pass.inputs[4])]
    ),
    cost: |_| 50.0,
    tolerance: Tolerance {
        absolute: 2e-4,
        relative: 2e-5,
        outliers: 2e-3,
        reason: "a few roundings of energies, which the inhibition magnifies",
    },
});

/// (u alpha, alpha) of a response on a lightness (L alpha, alpha) with lines along a field (E - G, F), inhibited by the
/// averaged energy of lines ([`line_energy`](super::line_energy)) around and close by.
pub fn pass(plan: &mut PlanBuilder, images: [ImageId; 5], params: &Params) -> ImageId {
    plan.pass(&KERNEL, &images, params, Class::Field, Support::Pixels(0))
}

#[inline(always)]
fn inhibited<S: Simd>(
    params: &Params,
    [[u, alpha], [l, covered], [difference, f]]: [[f32x8<S>; 2]; 3],
    [[e, cross, g, _], [near_e, _, near_g, _]]: [[f32x8<S>; 4]; 2],
) -> [f32x8<S>; 2] {
    let ground = l.at_least(covered * params.least) * params.base;
    let (_, [x, y]) = axis(difference * 0.5, f);
    let own = x * (e * x + cross * 2.0 * y) + g * y * y;
    let around = e + g + own * (params.own - 1.0);
    let excess = (around - (near_e + near_g) * params.excused).at_least(0.0);
    let raised = u + excess * params.inhibition;
    [u.simd_lt(ground).select(raised.at_most(ground), u), alpha]
}
