//! The diffusion tensor of edge-enhancing or coherence-enhancing diffusion (§ 3.1, Weickert 1998 and
//! 1999) from a smoothed structure tensor, as the weights of the step that follows.
//!
//! With D = (a, b; b, c) these are (max(a - |b|, 0), max(c - |b|, 0), max(b, 0), max(-b, 0)) towards
//! the neighbours on the x axis, the y axis and the two diagonals. Where D is so anisotropic that an
//! axis would get a negative weight, it gets none: the direction is then blurred a little, and no step
//! leaves the range of its neighbourhood.
//!
//! Cost: an eigenanalysis and an exponential, about 80 operations.

use crate::choice::Numbered;
pub use crate::kernels::shaders::diffusion_tensor::Params;
use crate::kernels::shared::tensor::{Eigen, eigen};
use crate::kernels::simd::pixels::map_pixels;
use isophote_engine::fearless_simd::{Simd, dispatch, f32x8, prelude::*};
use isophote_engine::math::Elementary;
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(diffusion_tensor {
    cpu: run,
    cost: |_| 80.0,
    tolerance: Tolerance {
        absolute: 2e-4,
        relative: 1e-4,
        outliers: 0.01,
        reason: "powers of eigenvalues, and directions of nearly isotropic tensors, which turn by many \
                 roundings",
    },
});

crate::choice::numbered! {
    /// Scheme of the diffusion.
    pub enum Scheme {
        /// 1 - exp(-3.31488 / (lambda1 / lambda^2)^4) across edges, 1 along them.
        EdgeEnhancing = 0,
        /// 0.001 across, 0.001 + 0.999 exp(-(contrast^2 / (lambda1 - lambda2))^2) along.
        CoherenceEnhancing = 1,
    }
}

/// The weights for `scheme`; `contrast` is lambda, or the fourth root of Weickert's C, in the unit of
/// the gradients that the tensors are made of.
pub fn pass(plan: &mut PlanBuilder, tensors: ImageId, scheme: Scheme, contrast: f32) -> ImageId {
    let params = Params { falloff: 1.0 / (contrast * contrast).max(1e-12), scheme: scheme.number() };
    plan.pass(&KERNEL, &[tensors], &params, Class::Field, Support::Pixels(0))
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    dispatch!(pass.level, simd => map_pixels(simd, pass, band, #[inline(always)] |tensor| of(simd, tensor, &params)));
}

#[inline(always)]
fn of<S: Simd>(simd: S, [e, f, g, _]: [f32x8<S>; 4], params: &Params) -> [f32x8<S>; 4] {
    let c = |v: f32| f32x8::splat(simd, v);
    let Eigen { lambda1, lambda2, major: [nx, ny] } = eigen(e, f, g);
    let (across, along) = if params.scheme == Scheme::CoherenceEnhancing as u32 {
        let q = ((lambda1 - lambda2) * params.falloff).at_most(c(1e9));
        let exponent = (c(1.0) / (q * q).at_least(c(1e-18))).at_most(c(87.0));
        (c(0.001), (-exponent).exp() * 0.999 + 0.001)
    } else {
        let s = (lambda1 * params.falloff).at_most(c(1e8));
        let s4 = (s * s) * (s * s);
        let exponent = (c(3.314_88) / s4.at_least(c(1e-30))).at_most(c(87.0));
        (c(1.0) - (-exponent).exp(), c(1.0))
    };
    let a = across * nx * nx + along * ny * ny;
    let b = (across - along) * nx * ny;
    let d = across * ny * ny + along * nx * nx;
    let size = b.abs();
    [(a - size).at_least(c(0.0)), (d - size).at_least(c(0.0)), (size + b) * 0.5, (size - b) * 0.5]
}
