//! The logarithm of a tensor, or back: its eigenvalues' at the same eigenvectors. Interpolated between
//! them (the log-Euclidean mean of Arsigny et al., *Log-Euclidean Metrics for Fast and Simple Calculus on
//! Diffusion Tensors*, 2006), a field keeps its shape where it falls off like a Gaussian; between the
//! tensors themselves the larger outweighs the smaller on the whole way, and edges come out wider.
//!
//! Cost: one eigenanalysis and two logarithms or powers.

pub use crate::kernels::shaders::tensor_logarithm::Params;
use crate::kernels::shared::tensor::{axis, eigen};
use crate::kernels::simd::pixels::map_pixels;
use isophote_engine::fearless_simd::{Simd, dispatch, f32x8, prelude::*};
use isophote_engine::math::Elementary;
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(tensor_logarithm {
    cpu: run,
    cost: |_| 60.0,
    tolerance: Tolerance::of_rounding(
        2e-4,
        2e-5,
        "the smaller eigenvalue of a tensor of nearly one direction is a small difference of large \
                 numbers, and its logarithm has that relative error"
    ),
});

/// A gradient of 1e-6 a pixel: what is below has no direction.
pub const LEAST: f32 = 1e-12;
/// Keeps the smaller eigenvalue of an edge above rounding.
const SHARE: f32 = 1e-3;

/// Adds the pass: tensors to their logarithms.
pub fn pass(plan: &mut PlanBuilder, tensor: ImageId) -> ImageId {
    convert(plan, tensor, 0)
}

/// Adds the pass: logarithms to their tensors.
pub fn pass_inverse(plan: &mut PlanBuilder, logarithm: ImageId) -> ImageId {
    convert(plan, logarithm, 1)
}

fn convert(plan: &mut PlanBuilder, image: ImageId, inverse: u32) -> ImageId {
    let params = Params { inverse, least: LEAST, share: SHARE };
    plan.pass(&KERNEL, &[image], &params, Class::Field, Support::Pixels(0))
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    dispatch!(pass.level, simd => map_pixels(simd, pass, band, #[inline(always)] |[e, f, g, w]| {
        let [e, f, g] = if params.inverse != 0 { back(e, f, g) } else { forth(&params, e, f, g) };
        [e, f, g, w]
    }));
}

#[inline(always)]
fn forth<S: Simd>(params: &Params, e: f32x8<S>, f: f32x8<S>, g: f32x8<S>) -> [f32x8<S>; 3] {
    let least = f32x8::splat(e.simd, params.least);
    let eigen = eigen(e, f, g);
    let larger = eigen.lambda1.at_least(least);
    let smaller = eigen.lambda2.at_least(least).at_least(larger * params.share);
    composed(larger.ln(), smaller.ln(), eigen.major)
}

#[inline(always)]
fn back<S: Simd>(e: f32x8<S>, f: f32x8<S>, g: f32x8<S>) -> [f32x8<S>; 3] {
    let mean = (e + g) * 0.5;
    let (radius, major) = axis((e - g) * 0.5, f);
    composed((mean + radius).exp(), (mean - radius).exp(), major)
}

/// The tensor with the eigenvalue `a` along the unit vector and `b` across.
#[inline(always)]
fn composed<S: Simd>(a: f32x8<S>, b: f32x8<S>, [x, y]: [f32x8<S>; 2]) -> [f32x8<S>; 3] {
    let (xx, yy) = (x * x, y * y);
    [a * xx + b * yy, (a - b) * x * y, a * yy + b * xx]
}
