//! Second pass of the separable flow-based difference of Gaussians along stream lines after Cabral and
//! Leedom (§ 2.9.4, 4.5): response and field are constant on pixels, so that the Gaussian is integrated
//! exactly (2.193), and the result is that of the two-dimensional kernel to rounding.
//!
//! Cost: up to 6 sigma_m segments per pixel, each one reading response and field, with a tangent, two
//! divisions and the error function, about 100 operations.

pub use crate::kernels::shaders::flow_dog_cabral_leedom::Params;
use crate::kernels::shared::edge_threshold::{Xdog, edge_of_sums};
use crate::kernels::shared::pixel_line::GaussianLines;
use crate::kernels::shared::stream::half_length;
use crate::kernels::shared::tensor::tangent;
use crate::kernels::simd::pixels::{fetch1, for_blocks, offsets, write};
use isophote_engine::fearless_simd::{Simd, f32x8, i32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(flow_dog_cabral_leedom {
    cpu: |simd, pass, params, band| smooth(simd, pass, &params, band),
    cost: |p| 2.0 * 1.3 * f64::from(half_length(p.sigma)) * 100.0 + 50.0,
    tolerance: Tolerance {
        absolute: 2e-3,
        relative: 1e-3,
        outliers: 0.02,
        reason: "where a line meets a corner, or two opposite tangents are equally near, the last bit \
                 decides which pixels it takes, which the slope of the threshold magnifies",
    },
});

/// The edge image of a `response` (u alpha, alpha): smoothed along the stream lines of `field` (E - G, F) by
/// standard deviation `sigma` pixels, thresholded as `xdog` says.
pub fn pass(plan: &mut PlanBuilder, response: ImageId, field: ImageId, sigma: f32, xdog: &Xdog) -> ImageId {
    let params = Params {
        sigma,
        threshold: xdog.threshold as u32,
        epsilon: xdog.epsilon,
        phi: xdog.phi,
        faintness: xdog.faintness,
    };
    // No pixel lies farther than the line is long.
    let support = Support::Pixels(half_length(sigma) as u32 + 1);
    plan.pass(&KERNEL, &[response, field], &params, Class::Field, support)
}

#[inline(always)]
fn smooth<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, band: &mut Band<'_>) {
    let (response, field) = (&pass.inputs[0], &pass.inputs[1]);
    let lines = GaussianLines::new(simd, params.sigma);
    for_blocks::<1>(
        band,
        #[inline(always)]
        |block, target| {
            let [difference, f] = block.read(simd, field);
            let [tx, ty] = tangent(difference, f, f32x8::splat(simd, 0.0));
            // A line of no length is the pixel itself.
            let own = if lines.limit[0] <= 0.0 { 1.0 } else { 0.0 };
            let [mut sum, mut norm] = block.read(simd, response);
            sum *= own;
            norm *= own;
            for side in [-1.0, 1.0] {
                lines.trace(
                    simd,
                    field,
                    block.centres(simd),
                    [tx * side, ty * side],
                    #[inline(always)]
                    |[x, y], weight| {
                        let at = offsets(response, x, y);
                        sum = weight.mul_add(fetch1(simd, response, at), sum);
                        norm = weight.mul_add(fetch1(simd, response, at + i32x8::splat(simd, 1)), norm);
                    },
                );
            }
            let Params { threshold, epsilon, phi, faintness, .. } = *params;
            write([edge_of_sums([sum, norm], threshold, epsilon, phi, faintness)], target);
        },
    );
}
