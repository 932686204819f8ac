//! The flow-based difference of Gaussians as it was first proposed, in one pass (§ 4.5, Figure 4.6 a): a
//! stream line is traced, at each of its points a one-dimensional difference of Gaussians is taken across
//! it, and a Gaussian along the line adds them up.
//!
//! Cost: the steps of the second pass times the samples of the first: about 4 sigma_m times 6 k sigma_e
//! bilinear samples of two values.

use crate::declare::choice::Numbered;
use crate::kernels::lines::flow_dog_gradient::halfwidth;
pub use crate::kernels::shaders::flow_dog_two_dimensional::Params;
use crate::kernels::shared::edge_threshold::{Xdog, dog_of_sums, edge_of_sums};
use crate::kernels::shared::pixel_line::GaussianLines;
use crate::kernels::shared::sampling::sample_linear2;
use crate::kernels::shared::stream::{FieldView, Integrator, Stream, half_length};
use crate::kernels::shared::tensor::tangent;
use crate::kernels::simd::pixels::{Block, for_blocks, write};
use crate::kernels::trace::Lines;
use isophote_engine::fearless_simd::{Simd, dispatch, f32x8, prelude::*};
use isophote_engine::math::Elementary;
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance, View};

crate::kernel!(flow_dog_two_dimensional {
    cpu: run,
    cost: |p| {
        let across = f64::from(p.halfwidth) * 0.88 * 70.0 + 100.0;
        (2.0 * f64::from(half_length(p.sigma)) + 1.0) * (across + 110.0)
    },
    tolerance: Tolerance {
        absolute: 2e-3,
        relative: 1e-3,
        outliers: 0.02,
        reason: "stream lines and slopes add up roundings, which the slope of the threshold magnifies; \
                 where the field is undetermined the last bit decides where a line goes",
    },
});

/// Method by which the stream line is traced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stepping {
    /// In steps of one pixel.
    Along(Integrator),
    /// From pixel boundary to pixel boundary (§ 2.9.4); points are the pixels that the line takes.
    CabralLeedom,
}

impl Stepping {
    /// Number by which the shader knows it.
    const fn number(self) -> u32 {
        match self {
            Self::Along(integrator) => integrator as u32,
            Self::CabralLeedom => 3,
        }
    }
}

/// Options of the filter; lengths in pixels.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Standard deviation of the narrower Gaussian across lines.
    pub sigma_e: f32,
    /// Ratio of the two standard deviations across lines.
    pub k: f32,
    /// Standard deviation along lines.
    pub sigma_m: f32,
    /// Method by which lines are stepped.
    pub stepping: Stepping,
    /// Weights and threshold.
    pub xdog: Xdog,
}

/// The edge image of (L alpha, alpha) on the field (E - G, F), for standard deviations `sigma_e` and `k`
/// `sigma_e` pixels across and `sigma_m` along the lines. What `marked` is darker than `lightness` is added
/// to the response, which is how guides draw lines.
pub fn pass(plan: &mut PlanBuilder, [lightness, field, marked]: [ImageId; 3], options: &Options) -> ImageId {
    let Options { sigma_e, k, sigma_m, stepping, xdog } = *options;
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
        faintness: xdog.faintness,
    };
    // Along the line, across it, and one pixel for the bilinear sample.
    let support = Support::Pixels(half_length(sigma_m) as u32 + halfwidth as u32 + 2);
    plan.pass(&KERNEL, &[lightness, field, marked], &params, Class::Field, support)
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    let filter = Filter {
        lightness: &pass.inputs[0],
        field: FieldView::new(pass.inputs[1]),
        marked: &pass.inputs[2],
        params: &params,
    };
    dispatch!(pass.level, simd => for_blocks::<1>(band, #[inline(always)] |block, target| {
        let sums = filter.along(simd, &block);
        let edge = edge_of_sums(sums, params.threshold, params.epsilon, params.phi, params.faintness);
        write([edge], target);
    }));
}

/// Values that all blocks of a band share.
struct Filter<'a> {
    lightness: &'a View<'a>,
    field: FieldView<'a>,
    marked: &'a View<'a>,
    params: &'a Params,
}

impl Filter<'_> {
    /// Weighted sums of (u alpha, alpha) along the lines through a block, one side after the other.
    #[inline(always)]
    fn along<S: Simd>(&self, simd: S, block: &Block) -> [f32x8<S>; 2] {
        let zero = f32x8::splat(simd, 0.0);
        let (params, field) = (self.params, &self.field);
        let [difference, f] = block.read(simd, &field.tensors);
        let [tx, ty] = tangent(difference, f, zero);
        let centre = block.centres(simd);
        let by_pixels = params.stepping == Stepping::CabralLeedom.number();
        let limit = half_length(params.sigma);
        let mut sum = [zero; 2];
        if !by_pixels || limit <= 0.0 {
            self.add(simd, &mut sum, zero + 1.0, centre, [tx, ty]);
        }
        for side in [-1.0, 1.0] {
            let direction = [tx * side, ty * side];
            if by_pixels {
                GaussianLines::new(simd, params.sigma).trace(
                    simd,
                    &field.tensors,
                    centre,
                    direction,
                    #[inline(always)]
                    |[x, y], weight| {
                        let middle = [x.to_float::<f32x8<S>>() + 0.5, y.to_float::<f32x8<S>>() + 0.5];
                        let here = field.tangent(simd, middle[0], middle[1]);
                        self.add(simd, &mut sum, weight, middle, here);
                    },
                );
                continue;
            }
            let falloff = -0.721_347_52 / (params.sigma * params.sigma).max(1e-6);
            let line = [Stream::begin(centre[0], centre[1], direction)];
            Lines::new(simd, field, Integrator::of(params.stepping), line).trace(
                simd,
                field,
                [zero + 1.0],
                limit as usize,
                #[inline(always)]
                |k, _, point| {
                    let weight = f32x8::splat(simd, (falloff * ((k + 1) * (k + 1)) as f32).exp2());
                    let [x, y] = point.place;
                    let here = field.tangent(simd, x, y);
                    self.add(simd, &mut sum, point.active.select(weight, zero), [x, y], here);
                    point.active
                },
            );
        }
        sum
    }

    /// Adds the response across the tangent at (x, y), (u alpha, alpha), times `weight`. It is called, not inlined: five samples
    /// for every pair of steps, at the start and on either side of two kinds of lines, made one function that took a
    /// third of the time in which the library compiles.
    #[inline(always)]
    fn add<S: Simd>(
        &self,
        simd: S,
        sum: &mut [f32x8<S>; 2],
        weight: f32x8<S>,
        place: [f32x8<S>; 2],
        tangent: [f32x8<S>; 2],
    ) {
        let [u, alpha] = simd.vectorize(
            #[inline(always)]
            || self.across(simd, place, tangent),
        );
        sum[0] = weight.mul_add(u, sum[0]);
        sum[1] = weight.mul_add(alpha, sum[1]);
    }

    /// The response across the tangent at (x, y): (u alpha and lines, alpha).
    #[inline(always)]
    fn across<S: Simd>(&self, simd: S, [x, y]: [f32x8<S>; 2], [tx, ty]: [f32x8<S>; 2]) -> [f32x8<S>; 2] {
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
        let (u, covered) = dog_of_sums([narrow, narrow_alpha], [wide, wide_alpha], params.base, params.edge);
        let u = covered.select(u, zero);
        [u * alpha + lines, alpha]
    }
}
