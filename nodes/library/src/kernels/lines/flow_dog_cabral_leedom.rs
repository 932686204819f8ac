//! Second pass of the separable flow-based difference of Gaussians along stream lines after Cabral and
//! Leedom (§ 2.9.4, 4.5): response and field are constant on pixels, so that the Gaussian is integrated
//! exactly (2.193), and the result is that of the two-dimensional kernel to rounding.
//!
//! Cost: up to 6 sigma_m segments per pixel, each one reading response and field, with a tangent, two
//! divisions and the error function, about 100 operations.

pub use crate::kernels::shaders::flow_dog_cabral_leedom::Params;
use crate::kernels::shared::coverage::LEAST_COVERAGE;
use crate::kernels::shared::edge_threshold::{Xdog, edge_threshold, edge_uncovered};
use crate::kernels::shared::pixel_line::{PixelLine, error_function, most_steps};
use crate::kernels::shared::tensor::tangent;
use crate::kernels::simd::pixels::{fetch1, for_blocks, offsets, write};
use isophote_engine::fearless_simd::{Simd, dispatch, f32x8, i32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(flow_dog_cabral_leedom {
    cpu: run,
    cost: |params| {
        let p: Params = bytemuck::pod_read_unaligned(params);
        2.0 * 1.3 * f64::from(radius(p.sigma)) * 100.0 + 50.0
    },
    tolerance: Tolerance {
        absolute: 2e-3,
        relative: 1e-3,
        outliers: 0.02,
        reason: "where a line meets a corner, or two opposite tangents are equally near, the last bit \
                 decides which pixels it takes, which the slope of the threshold magnifies",
    },
});

/// L = floor(2 sigma) (§ 2.9.3); a last bit must not decide whether a whole number is reached.
fn radius(sigma: f32) -> f32 {
    (2.0 * sigma + 1e-3).floor()
}

/// The edge image of a `response` (u alpha, alpha): smoothed along the stream lines of `field` (E - G, F) by
/// standard deviation `sigma` pixels, thresholded as `xdog` says.
pub fn edges(plan: &mut PlanBuilder, response: ImageId, field: ImageId, sigma: f32, xdog: &Xdog) -> ImageId {
    let params = Params { sigma, threshold: xdog.threshold as u32, epsilon: xdog.epsilon, phi: xdog.phi };
    let support = Support::Pixels(radius(sigma) as u32 + 1);
    plan.pass(&KERNEL, &[response, field], &params, Class::Field, support)
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    dispatch!(pass.level, simd => smooth(simd, pass, &params, band));
}

#[inline(always)]
fn smooth<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, band: &mut Band<'_>) {
    let (response, field) = (&pass.inputs[0], &pass.inputs[1]);
    let limit = radius(params.sigma);
    let steps = most_steps(limit);
    let inverse = std::f32::consts::FRAC_1_SQRT_2 / params.sigma.max(1e-3);
    for_blocks::<1>(
        band,
        #[inline(always)]
        |block, target| {
            let zero = f32x8::splat(simd, 0.0);
            let [difference, f] = block.read(simd, field);
            let [tx, ty] = tangent(difference, f, zero);
            let [x, y] = block.centres(simd);
            // A line of no length is the pixel itself.
            let own = if limit <= 0.0 { 1.0 } else { 0.0 };
            let [mut sum, mut norm] = block.read(simd, response);
            sum *= own;
            norm *= own;
            for side in [-1.0, 1.0] {
                let mut line = PixelLine::begin(x, y, [tx * side, ty * side]);
                let (mut u, mut passed) = (zero, zero);
                let mut active = u.simd_lt(limit);
                for _ in 0..steps {
                    if !active.any_true() {
                        break;
                    }
                    let h = line.aim(simd, field);
                    let end = (u + h).min(limit);
                    let reached = error_function(end * inverse);
                    let weight = active.select(reached - passed, zero);
                    let [px, py] = line.pixels();
                    let at = offsets(response, px, py);
                    sum = weight.mul_add(fetch1(simd, response, at), sum);
                    norm = weight.mul_add(fetch1(simd, response, at + i32x8::splat(simd, 1)), norm);
                    (u, passed) = (end, reached);
                    active &= u.simd_lt(limit);
                    active = line.cross(field, h, active);
                }
            }
            let covered = norm.simd_gt(LEAST_COVERAGE);
            let u = sum / covered.select(norm, zero + 1.0);
            let edge = edge_threshold(u, params.threshold, params.epsilon, params.phi);
            write([covered.select(edge, zero + edge_uncovered(params.threshold))], target);
        },
    );
}
