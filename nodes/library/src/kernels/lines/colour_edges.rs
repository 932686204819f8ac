//! Differences of Gaussians of L, a and b as one: their length in CIELAB, with the sign of the darker side, so that colours
//! of one lightness have lines between them. Where lightness does not tell the sides apart, the greener and bluer one counts
//! as the darker, so that lines keep to one side. The thesis finds lines in L alone (§ 4.6).
//!
//! Cost: two square roots and a division per pixel.

pub use crate::kernels::shaders::colour_edges::Params;
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Class, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(colour_edges {
    block: |simd, pass, params| |block| joined(
        &params,
        block.read(simd, &pass.inputs[0]),
        block.read(simd, &pass.inputs[1]),
        block.read(simd, &pass.inputs[2])
    ),
    cost: |_| 40.0,
    tolerance: Tolerance {
        absolute: 1e-4,
        relative: 1e-4,
        outliers: 1e-2,
        reason: "the sign of an edge of two colours of one lightness is a quotient of small sums",
    },
});

/// (u alpha, alpha) of the differences of Gaussians of L, a and b, each times coverage.
pub fn pass(plan: &mut PlanBuilder, differences: [ImageId; 3], params: &Params) -> ImageId {
    plan.pass(&KERNEL, &differences, params, Class::Field, Support::Pixels(0))
}

#[inline(always)]
fn joined<S: Simd>(
    params: &Params,
    [l, alpha]: [f32x8<S>; 2],
    [a, _]: [f32x8<S>; 2],
    [b, _]: [f32x8<S>; 2],
) -> [f32x8<S>; 2] {
    let (a, b) = (a * params.weight, b * params.weight);
    let chroma = a * a + b * b;
    let length = (l * l + chroma).sqrt();
    let side = (l * 3.0 + a * 0.8 + b * 0.6) / (chroma.sqrt() * 0.3 + 1e-6);
    [l + side.within(-1.0, 1.0) * (length - l.abs()), alpha]
}
