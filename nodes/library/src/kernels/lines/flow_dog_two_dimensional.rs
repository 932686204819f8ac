//! The flow-based difference of Gaussians as it was first proposed, in one pass (§ 4.5, Figure 4.6 a): a
//! stream line is traced, at each of its points a one-dimensional difference of Gaussians is taken across
//! it, and a Gaussian along the line adds them up.
//!
//! Cost: the steps of the second pass times the samples of the first: about 4 sigma_m times 6 k sigma_e
//! bilinear samples of two values.

use crate::kernels::lines::flow_dog_gradient::halfwidth;
pub use crate::kernels::shaders::flow_dog_two_dimensional::Params;
use crate::kernels::shared::coverage::LEAST_COVERAGE;
use crate::kernels::shared::edge_threshold::{Xdog, dog_response, edge_threshold, edge_uncovered};
use crate::kernels::shared::pixel_line::{PixelLine, error_function, most_steps};
use crate::kernels::shared::sampling::sample_linear2;
use crate::kernels::shared::stream::{Integrator, Stream, StreamField};
use crate::kernels::shared::tensor::tangent;
use crate::kernels::simd::pixels::{for_blocks, write};
use isophote_engine::fearless_simd::{Simd, dispatch, f32x8, mask32x8, prelude::*};
use isophote_engine::math::Elementary;
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance, View};

crate::kernel!(flow_dog_two_dimensional {
    cpu: run,
    cost: |params| {
        let p: Params = bytemuck::pod_read_unaligned(params);
        let across = f64::from(p.halfwidth) * 0.88 * 70.0 + 100.0;
        (2.0 * f64::from(radius(p.sigma)) + 1.0) * (across + 110.0)
    },
    tolerance: Tolerance {
        absolute: 2e-3,
        relative: 1e-3,
        outliers: 0.02,
        reason: "stream lines and slopes add up roundings, which the slope of the threshold magnifies; \
                 where the field is undetermined the last bit decides where a line goes",
    },
});

/// How the stream line is traced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stepping {
    /// In steps of one pixel.
    Along(Integrator),
    /// From pixel boundary to pixel boundary (§ 2.9.4); points are the pixels that the line takes.
    CabralLeedom,
}

impl Stepping {
    /// What the shader calls it.
    const fn number(self) -> u32 {
        match self {
            Self::Along(integrator) => integrator as u32,
            Self::CabralLeedom => 3,
        }
    }
}

/// L = floor(2 sigma) (§ 2.9.3); a last bit must not decide whether a whole number is reached.
fn radius(sigma: f32) -> f32 {
    (2.0 * sigma + 1e-3).floor()
}

/// The edge image of (L alpha, alpha) on the field (E - G, F), for standard deviations `sigma_e` and `k`
/// `sigma_e` pixels across and `sigma_m` along the lines. What `marked` is darker than `lightness` is added
/// to the response, which is how guides draw lines.
pub fn edges(
    plan: &mut PlanBuilder,
    [lightness, field, marked]: [ImageId; 3],
    [sigma_e, k, sigma_m]: [f32; 3],
    stepping: Stepping,
    xdog: &Xdog,
) -> ImageId {
    let falloff = |sigma: f32| -0.5 / (sigma * sigma).max(1e-6);
    let halfwidth = halfwidth(sigma_e, k);
    let params = Params {
        narrow: falloff(sigma_e),
        wide: falloff(k * sigma_e),
        halfwidth,
        base: xdog.base,
        edge: xdog.edge,
        sigma: sigma_m,
        stepping: stepping.number(),
        threshold: xdog.threshold as u32,
        epsilon: xdog.epsilon,
        phi: xdog.phi,
    };
    // Along the line, across it, and one pixel for the bilinear sample.
    let support = Support::Pixels(radius(sigma_m) as u32 + halfwidth as u32 + 2);
    plan.pass(&KERNEL, &[lightness, field, marked], &params, Class::Field, support)
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    dispatch!(pass.level, simd => both_ways(simd, pass, &params, band));
}

#[inline(always)]
fn both_ways<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, band: &mut Band<'_>) {
    let field = &pass.inputs[1];
    let around = Around { lightness: &pass.inputs[0], marked: &pass.inputs[2], params };
    let stream = StreamField { tensors: *field, step: 1.0, integrator: Integrator::of(params.stepping) };
    let limit = radius(params.sigma);
    let falloff = -0.721_347_52 / (params.sigma * params.sigma).max(1e-6);
    let inverse = std::f32::consts::FRAC_1_SQRT_2 / params.sigma.max(1e-3);
    let by_pixels = params.stepping == Stepping::CabralLeedom.number();
    for_blocks::<1>(
        band,
        #[inline(always)]
        |block, target| {
            let zero = f32x8::splat(simd, 0.0);
            let [difference, f] = block.read(simd, field);
            let [tx, ty] = tangent(difference, f, zero);
            let [x, y] = block.centres(simd);
            let mut sum = [zero; 2];
            if !by_pixels || limit <= 0.0 {
                around.add(simd, &mut sum, zero + 1.0, [x, y], [tx, ty]);
            }
            for side in [-1.0, 1.0] {
                if by_pixels {
                    let mut line = PixelLine::begin(x, y, [tx * side, ty * side]);
                    let (mut u, mut passed) = (zero, zero);
                    let mut active = u.simd_lt(limit);
                    for _ in 0..most_steps(limit) {
                        if !active.any_true() {
                            break;
                        }
                        let h = line.aim(simd, field);
                        let end = (u + h).min(limit);
                        let reached = error_function(end * inverse);
                        let weight = active.select(reached - passed, zero);
                        let [px, py] = line.pixels();
                        let middle = [px.to_float::<f32x8<S>>() + 0.5, py.to_float::<f32x8<S>>() + 0.5];
                        let here = stream.tangent(simd, middle[0], middle[1]);
                        around.add(simd, &mut sum, weight, middle, here);
                        (u, passed) = (end, reached);
                        active &= u.simd_lt(limit);
                        active = line.cross(field, h, active);
                    }
                    continue;
                }
                let mut lines = [Stream::begin(x, y, [tx * side, ty * side])];
                let mut active = mask32x8::splat(simd, true);
                for u in 1..=limit as i32 {
                    stream.advance(simd, &mut lines, [active]);
                    let line = &lines[0];
                    active &= stream.inside(line);
                    let weight = f32x8::splat(simd, (falloff * (u * u) as f32).exp2());
                    let here = stream.tangent(simd, line.x, line.y);
                    around.add(simd, &mut sum, active.select(weight, zero), [line.x, line.y], here);
                }
            }
            let [sum, norm] = sum;
            let covered = norm.simd_gt(LEAST_COVERAGE);
            let u = sum / covered.select(norm, zero + 1.0);
            let edge = edge_threshold(u, params.threshold, params.epsilon, params.phi);
            write([covered.select(edge, zero + edge_uncovered(params.threshold))], target);
        },
    );
}

/// What lies around a stream line.
struct Around<'a> {
    lightness: &'a View<'a>,
    marked: &'a View<'a>,
    params: &'a Params,
}

impl Around<'_> {
    /// Adds the response across the tangent at (x, y), (u alpha, alpha), times `weight`.
    #[inline(always)]
    fn add<S: Simd>(
        &self,
        simd: S,
        sum: &mut [f32x8<S>; 2],
        weight: f32x8<S>,
        [x, y]: [f32x8<S>; 2],
        [tx, ty]: [f32x8<S>; 2],
    ) {
        let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
        let params = self.params;
        let upright = tx.abs().simd_gt(ty.abs());
        let slope = upright.select(-ty / tx, -tx / ty);
        let step = (slope * slope + 1.0).sqrt();
        let (dx, dy) = (upright.select(slope, one), upright.select(one, slope));
        let [middle, alpha] = sample_linear2(simd, self.lightness, x, y);
        let lines = sample_linear2(simd, self.marked, x, y)[0] - middle;
        let (mut narrow, mut narrow_alpha, mut wide, mut wide_alpha) = (middle, alpha, middle, alpha);
        for k in 1..=params.halfwidth as i32 {
            let k = k as f32;
            let d = step * k;
            let near = d.simd_le(params.halfwidth);
            let [l0, a0] =
                sample_linear2(simd, self.lightness, dx.mul_add(zero + k, x), dy.mul_add(zero + k, y));
            let [l1, a1] =
                sample_linear2(simd, self.lightness, dx.mul_add(zero - k, x), dy.mul_add(zero - k, y));
            let n = near.select((d * params.narrow * d).exp(), zero);
            let w = near.select((d * params.wide * d).exp(), zero);
            narrow = (l0 + l1).mul_add(n, narrow);
            narrow_alpha = (a0 + a1).mul_add(n, narrow_alpha);
            wide = (l0 + l1).mul_add(w, wide);
            wide_alpha = (a0 + a1).mul_add(w, wide_alpha);
        }
        let covered = narrow_alpha.min(wide_alpha).simd_gt(LEAST_COVERAGE);
        let narrow = narrow / covered.select(narrow_alpha, one);
        let wide = wide / covered.select(wide_alpha, one);
        let u = covered.select(dog_response(narrow, wide, params.base, params.edge), zero);
        sum[0] = weight.mul_add(u * alpha + lines, sum[0]);
        sum[1] = weight.mul_add(alpha, sum[1]);
    }
}
