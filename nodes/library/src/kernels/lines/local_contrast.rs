//! Response of a difference of Gaussians against the local deviation of its source, so that soft light draws lines and hard
//! light is not black: the divisive normalisation of contrast by which vision does it (Heeger, *Normalization of cell
//! responses in cat striate cortex*, 1992).
//!
//! Cost: a square root and two divisions per pixel.

pub use crate::kernels::shaders::local_contrast::Params;
use crate::kernels::shared::coverage::LEAST_COVERAGE;
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Class, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(local_contrast {
    block: |simd, pass, params| |block| evened(
        &params,
        block.read(simd, &pass.inputs[0]),
        block.read(simd, &pass.inputs[1]),
        block.read(simd, &pass.inputs[2])
    ),
    cost: |_| 30.0,
    tolerance: Tolerance {
        absolute: 1e-4,
        relative: 1e-3,
        outliers: 1e-2,
        reason: "the difference of the mean square and the squared mean loses digits, which the floor does not hide \
                 everywhere",
    },
});

/// (u alpha, alpha) of the response of a difference of Gaussians alone, of the lightness that it is found in, both times
/// coverage, and of the moments around each pixel ([`lightness_moments`](super::lightness_moments)).
pub fn pass(plan: &mut PlanBuilder, images: [ImageId; 3], params: &Params) -> ImageId {
    plan.pass(&KERNEL, &images, params, Class::Field, Support::Pixels(0))
}

#[inline(always)]
fn evened<S: Simd>(
    params: &Params,
    [u, alpha]: [f32x8<S>; 2],
    [l, covered]: [f32x8<S>; 2],
    [sum, squares, weight, _]: [f32x8<S>; 4],
) -> [f32x8<S>; 2] {
    let one = f32x8::splat(u.simd, 1.0);
    let inverse = one / weight.at_least(LEAST_COVERAGE);
    let mean = sum * inverse;
    let variance = (squares * inverse - mean * mean).at_least(0.0);
    let gain = f32x8::splat(u.simd, params.strength) / (variance * params.share + params.floor).sqrt();
    let factor = one + (gain - 1.0) * params.amount;
    let ground = l.at_least(covered * params.least) * params.base;
    [ground + u * factor, alpha]
}
