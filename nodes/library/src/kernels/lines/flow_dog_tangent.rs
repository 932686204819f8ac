//! Second pass of the separable flow-based difference of Gaussians: a Gaussian of the response along
//! the stream line of the tensor field (§ 2.9, 4.5), then the threshold (4.8).
//!
//! Cost: 4 sigma_m steps per pixel, each one bilinear sample of two values and one (Euler) or two
//! samples of orientation with their tangents, about 100 operations.

use crate::kernels::blocks::{BLOCK, Block, TILE, write1};
use crate::kernels::edge_threshold::{LEAST_COVERAGE, Xdog, edge_threshold, edge_uncovered};
use crate::kernels::stream_line::{Stream, StreamField, centres};
use crate::kernels::tensor_algebra::tangent;
use isophote_engine::fearless_simd::{Simd, dispatch, f32x8, mask32x8, prelude::*};
use isophote_engine::math::{InnerPlace, sample_inner2, sample_linear2};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance, View};

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
    let falloff = -0.721_347_52 / (params.sigma * params.sigma).max(1e-6);
    // All lanes share the arc length, and so the weights.
    let weights: Vec<f32> =
        (1..=radius(params.sigma) as i32).map(|u| (falloff * (u * u) as f32).exp2()).collect();
    let (window, reach) = (band.window, weights.len() as i32);
    let mut start = window.x0;
    while start < window.x1 {
        let end = (start + TILE).min(window.x1);
        for y in window.y0..window.y1 {
            let row = band.row_mut(0, y);
            let mut x = start;
            while x < end {
                let at = (x - window.x0) as usize;
                let len = (end - x).min(2 * BLOCK as i32);
                if len == 2 * BLOCK as i32 && field.is_inner(x, y, len, reach) {
                    inner(simd, params, response, &field, &weights, [x, y], &mut row[at..at + 2 * BLOCK]);
                    x += len;
                    continue;
                }
                let block = Block { x, y, len: BLOCK.min(len as usize) };
                let target = &mut row[at..at + block.len];
                clamped(simd, params, response, &field, &weights, &block, target);
                x += BLOCK as i32;
            }
        }
        start = end;
    }
}

/// Sixteen pixels from `at` on whose lines stay off the picture's edges.
///
/// A step is a long chain of operations that wait for each other; four of them, two blocks with two sides
/// each, fill the time.
#[inline(always)]
fn inner<S: Simd>(
    simd: S,
    params: &Params,
    response: &View<'_>,
    field: &StreamField<'_>,
    weights: &[f32],
    [x, y]: [i32; 2],
    target: &mut [f32],
) {
    let blocks = [Block { x, y, len: BLOCK }, Block { x: x + BLOCK as i32, y, len: BLOCK }];
    let ([a, b], [c, d]) = (begun(simd, field, &blocks[0]), begun(simd, field, &blocks[1]));
    let mut lines = [a, b, c, d];
    let mut sums = [blocks[0].read2(simd, response), blocks[1].read2(simd, response)];
    let mut here = [a.direction, b.direction, c.direction, d.direction];
    for (u, weight) in weights.iter().enumerate() {
        field.advance_inner(simd, &mut lines, &here);
        let weight = f32x8::splat(simd, *weight);
        for i in 0..4 {
            let place = InnerPlace::new(lines[i].x, lines[i].y);
            if u + 1 < weights.len() {
                here[i] = field.at_inner(simd, &place);
            }
            let [v, alpha] = sample_inner2(simd, response, &place);
            let [sum, norm] = sums[i / 2];
            sums[i / 2] = [weight.mul_add(v, sum), weight.mul_add(alpha, norm)];
        }
    }
    write1(line(params, sums[0]), &mut target[..BLOCK]);
    write1(line(params, sums[1]), &mut target[BLOCK..]);
}

/// Both sides of the lines through a block.
#[inline(always)]
fn begun<S: Simd>(simd: S, field: &StreamField<'_>, block: &Block) -> [Stream<S>; 2] {
    let [difference, f] = block.read2(simd, &field.tensors);
    let [x, y] = centres(simd, block.x, block.y, block.x + block.len as i32 - 1);
    Stream::both_sides(x, y, tangent(difference, f, f32x8::splat(simd, 0.0)))
}

/// Up to eight pixels anywhere.
#[inline(always)]
fn clamped<S: Simd>(
    simd: S,
    params: &Params,
    response: &View<'_>,
    field: &StreamField<'_>,
    weights: &[f32],
    block: &Block,
    target: &mut [f32],
) {
    let zero = f32x8::splat(simd, 0.0);
    let mut lines = begun(simd, field, block);
    let mut active = [mask32x8::splat(simd, true); 2];
    let [mut sum, mut norm] = block.read2(simd, response);
    for weight in weights {
        field.advance_both(simd, &mut lines, active);
        for side in 0..2 {
            active[side] &= field.inside(simd, &lines[side]);
            let weight = active[side].select(f32x8::splat(simd, *weight), zero);
            let [v, alpha] = sample_linear2(simd, response, lines[side].x, lines[side].y);
            sum = weight.mul_add(v, sum);
            norm = weight.mul_add(alpha, norm);
        }
    }
    write1(line(params, [sum, norm]), target);
}

/// The edge image of weighted sums of (u alpha, alpha).
#[inline(always)]
fn line<S: Simd>(params: &Params, [sum, norm]: [f32x8<S>; 2]) -> f32x8<S> {
    let zero = f32x8::splat(sum.simd, 0.0);
    let covered = norm.simd_gt(LEAST_COVERAGE);
    let u = sum / covered.select(norm, zero + 1.0);
    let edge = edge_threshold(u, params.threshold, params.epsilon, params.phi);
    covered.select(edge, zero + edge_uncovered(params.threshold))
}
