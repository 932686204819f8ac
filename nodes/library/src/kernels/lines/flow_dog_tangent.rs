//! Second pass of the separable flow-based difference of Gaussians: a Gaussian of the response along
//! the stream line of the tensor field (§ 2.9, 4.5), then the threshold (4.8).
//!
//! Cost: 4 sigma_m steps per pixel, each one bilinear sample of two values and one (Euler) or two
//! samples of orientation with their tangents, about 100 operations.

use crate::kernels::blocks::{for_blocks, write1};
use crate::kernels::edge_threshold::{LEAST_COVERAGE, Xdog, edge_threshold, edge_uncovered};
use crate::kernels::stream_line::{Stream, StreamField, centres};
use crate::kernels::tensor_algebra::tangent;
use isophote_engine::fearless_simd::{Simd, dispatch, f32x8, mask32x8, prelude::*};
use isophote_engine::math::sample_linear2;
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::params! {
    /// Uniform block.
    pub struct Params for flow_dog_tangent {
        /// Standard deviation along the line, pixels.
        pub sigma: f32,
        /// 1: second-order Runge-Kutta; 0: Euler.
        pub midpoint: u32,
        /// [`Threshold`](crate::kernels::edge_threshold::Threshold) as a number.
        pub threshold: u32,
        /// Response from which on there is no line.
        pub epsilon: f32,
        /// Steepness of the ramp.
        pub phi: f32,
    }
}

crate::kernel!(flow_dog_tangent {
    cpu: run,
    cost: |params| {
        let p: Params = bytemuck::pod_read_unaligned(params);
        2.0 * f64::from(radius(p.sigma)) * if p.midpoint != 0 { 110.0 } else { 60.0 } + 30.0
    },
    tolerance: Tolerance {
        absolute: 2e-3,
        relative: 1e-3,
        outliers: 0.02,
        reason: "stream lines add up roundings, which the slope of the threshold magnifies; where the \
                 field is undetermined the last bit decides where a line goes",
    },
});

/// L = floor(2 sigma) (§ 2.9.3); a last bit must not decide whether a whole number is reached.
fn radius(sigma: f32) -> f32 {
    (2.0 * sigma + 1e-3).floor()
}

/// The edge image of a `response` (u alpha, alpha): smoothed along the stream lines of `field` (E - G, F) by
/// standard deviation `sigma` pixels, thresholded as `xdog` says.
pub fn edges(
    plan: &mut PlanBuilder,
    response: ImageId,
    field: ImageId,
    sigma: f32,
    midpoint: bool,
    xdog: &Xdog,
) -> ImageId {
    let params = Params {
        sigma,
        midpoint: midpoint.into(),
        threshold: xdog.threshold as u32,
        epsilon: xdog.epsilon,
        phi: xdog.phi,
    };
    // A bilinear sample at distance L reads one pixel further.
    let support = Support::Pixels(radius(sigma) as u32 + 1);
    plan.pass(&KERNEL, &[response, field], &params, Class::Field, support)
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    dispatch!(pass.level, simd => smooth(simd, pass, &params, band));
}

#[inline(always)]
fn smooth<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, band: &mut Band<'_>) {
    let (response, tensors) = (&pass.inputs[0], &pass.inputs[1]);
    let field = StreamField { tensors: *tensors, step: 1.0, midpoint: params.midpoint != 0 };
    let steps = radius(params.sigma) as i32;
    let falloff = -0.721_347_52 / (params.sigma * params.sigma).max(1e-6);
    let last = band.window.x1 - 1;
    for_blocks::<1>(band, #[inline(always)] |block, target| {
        let zero = f32x8::splat(simd, 0.0);
        let [difference, f] = block.read2(simd, tensors);
        let [tx, ty] = tangent(difference, f, zero);
        let [x, y] = centres(simd, block.x, block.y, last);
        let [mut sum, mut norm] = block.read2(simd, response);
        for side in [-1.0, 1.0] {
            let mut line = Stream::begin(x, y, [tx * side, ty * side]);
            let mut active = mask32x8::splat(simd, true);
            for u in 1..=steps {
                field.advance(simd, &mut line, active);
                active &= field.inside(simd, &line);
                // The lanes share the arc length, so one power serves them all.
                let weight = active.select(f32x8::splat(simd, (falloff * (u * u) as f32).exp2()), zero);
                let [v, alpha] = sample_linear2(simd, response, line.x, line.y);
                sum = weight.mul_add(v, sum);
                norm = weight.mul_add(alpha, norm);
            }
        }
        let covered = norm.simd_gt(LEAST_COVERAGE);
        let u = sum / covered.select(norm, zero + 1.0);
        let edge = edge_threshold(u, params.threshold, params.epsilon, params.phi);
        write1(covered.select(edge, zero + edge_uncovered(params.threshold)), target);
    });
}
