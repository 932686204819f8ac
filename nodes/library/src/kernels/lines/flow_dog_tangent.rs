//! Second pass of the separable flow-based difference of Gaussians: a Gaussian of the response along
//! the stream line of the tensor field (§ 2.9, 4.5), then the threshold (4.8).
//!
//! Cost: 4 sigma_m steps per pixel, each one bilinear sample of two values and one (Euler, two-step) or two
//! samples of orientation with their tangents, about 70 or 110 operations.

pub use crate::kernels::shaders::flow_dog_tangent::Params;
use crate::kernels::shared::coverage::LEAST_COVERAGE;
use crate::kernels::shared::edge_threshold::{Xdog, edge_threshold, edge_uncovered};
use crate::kernels::shared::sampling::sample_linear2;
use crate::kernels::shared::stream::{Integrator, NearField, Stream, StreamField, holds};
use crate::kernels::shared::tensor::tangent;
use crate::kernels::simd::pixels::{BLOCK, Block, for_blocks_in_tiles, write};
use crate::kernels::simd::tile_copy::{Frame, Place, Surroundings, TWO};
use isophote_engine::fearless_simd::{Simd, dispatch, f32x8, mask32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance, View};

crate::kernel!(flow_dog_tangent {
    cpu: run,
    cost: |params| {
        let p: Params = bytemuck::pod_read_unaligned(params);
        2.0 * f64::from(radius(p.sigma))
            * if p.integrator == Integrator::Midpoint as u32 { 110.0 } else { 70.0 }
            + 30.0
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
    integrator: Integrator,
    xdog: &Xdog,
) -> ImageId {
    let params = Params {
        sigma,
        integrator: integrator as u32,
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
    let falloff = -0.721_347_52 / (params.sigma * params.sigma).max(1e-6);
    // All lanes share the arc length, and so the weights.
    let weights: Vec<f32> =
        (1..=radius(params.sigma) as i32).map(|u| (falloff * (u * u) as f32).exp2()).collect();
    let reach = weights.len() as i32 + 1;
    let integrator = Integrator::of(params.integrator);
    if !Frame::suits(reach) {
        let field = StreamField { tensors: *tensors, step: 1.0, integrator };
        for_blocks_in_tiles::<1>(band, |block, target| {
            write([line(params, far(simd, response, &field, &weights, &block))], target);
        });
        return;
    }
    let (mut responses, mut field) = (Surroundings::default(), Surroundings::default());
    let window = band.window;
    for frame in Frame::tiles(window, reach) {
        responses.load(response, &frame);
        field.load(tensors, &frame);
        let near = NearField { frame: &frame, tensors: &field, integrator };
        let edges = frame.meets_edges(tensors.full()).then_some(tensors.full());
        let columns = (frame.tile.x0 - window.x0) as usize..(frame.tile.x1 - window.x0) as usize;
        for y in frame.tile.y0..frame.tile.y1 {
            let row = &mut band.row_mut(0, y)[columns.clone()];
            for (i, target) in row.chunks_mut(2 * BLOCK).enumerate() {
                let x = frame.tile.x0 + (2 * BLOCK * i) as i32;
                let len = target.len();
                // A block behind the end of the row does the first one's work again.
                let second = if len > BLOCK { BLOCK } else { 0 };
                let blocks = [
                    Block { x, y, len: len.min(BLOCK) },
                    Block { x: x + second as i32, y, len: (len - second).min(BLOCK) },
                ];
                let sums = sums(simd, [response, tensors], &responses, &near, edges, &weights, &blocks);
                for (sum, target) in sums.into_iter().zip(target.chunks_mut(BLOCK)) {
                    write([line(params, sum)], target);
                }
            }
        }
    }
}

/// Weighted sums of (u alpha, alpha) along the lines through two blocks; `edges` is the size of the picture
/// where lines may leave it.
///
/// A step is a long chain of operations that wait for each other; four of them, two blocks with two sides
/// each, fill the time.
#[inline(always)]
fn sums<S: Simd>(
    simd: S,
    [response, tensors]: [&View<'_>; 2],
    responses: &Surroundings<TWO>,
    field: &NearField<'_>,
    edges: Option<[i32; 2]>,
    weights: &[f32],
    blocks: &[Block; 2],
) -> [[f32x8<S>; 2]; 2] {
    let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
    let ([a, b], [c, d]) = (begun(simd, tensors, &blocks[0]), begun(simd, tensors, &blocks[1]));
    let mut lines = [a, b, c, d];
    let mut active = [mask32x8::splat(simd, true); 4];
    let mut sums = [blocks[0].read(simd, response), blocks[1].read(simd, response)];
    let mut places = [Place::new(field.frame, lines[0].x, lines[0].y); 4];
    for weight in weights {
        field.advance(simd, &mut lines, &places, [one; 4]);
        for i in 0..4 {
            places[i] = Place::new(field.frame, lines[i].x, lines[i].y);
            let mut weight = f32x8::splat(simd, *weight);
            if let Some(full) = edges {
                active[i] &= holds(full, lines[i].x, lines[i].y);
                weight = active[i].select(weight, zero);
            }
            let [v, alpha] = responses.sample(simd, &places[i]);
            let [sum, norm] = sums[i / 2];
            sums[i / 2] = [weight.mul_add(v, sum), weight.mul_add(alpha, norm)];
        }
    }
    sums
}

/// Both sides of the lines through a block.
#[inline(always)]
fn begun<S: Simd>(simd: S, tensors: &View<'_>, block: &Block) -> [Stream<S>; 2] {
    let [difference, f] = block.read(simd, tensors);
    let [x, y] = block.centres(simd);
    Stream::both_sides(x, y, tangent(difference, f, f32x8::splat(simd, 0.0)))
}

/// The same sums for one block whose lines reach too far for copies of what is around tiles.
#[inline(always)]
fn far<S: Simd>(
    simd: S,
    response: &View<'_>,
    field: &StreamField<'_>,
    weights: &[f32],
    block: &Block,
) -> [f32x8<S>; 2] {
    let zero = f32x8::splat(simd, 0.0);
    let mut lines = begun(simd, &field.tensors, block);
    let mut active = [mask32x8::splat(simd, true); 2];
    let [mut sum, mut norm] = block.read(simd, response);
    for weight in weights {
        field.advance(simd, &mut lines, active);
        for side in 0..2 {
            active[side] &= field.inside(&lines[side]);
            let weight = active[side].select(f32x8::splat(simd, *weight), zero);
            let [v, alpha] = sample_linear2(simd, response, lines[side].x, lines[side].y);
            sum = weight.mul_add(v, sum);
            norm = weight.mul_add(alpha, norm);
        }
    }
    [sum, norm]
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
