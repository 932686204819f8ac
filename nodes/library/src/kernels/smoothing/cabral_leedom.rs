//! Line integral convolution of a colour with a Gaussian along stream lines after Cabral and Leedom
//! (§ 2.9.4): image and field are constant on pixels, and the Gaussian is integrated exactly (2.193).
//!
//! Cost: up to 6 sigma segments per pixel, each one colour and one tensor with its tangent, two divisions
//! and the error function, about 120 operations.

pub use crate::kernels::shaders::cabral_leedom::Params;
use crate::kernels::shared::coverage::{Covered, unpremultiply};
use crate::kernels::shared::pixel_line::{GaussianLines, most_steps};
use crate::kernels::shared::stream::half_length;
use crate::kernels::shared::tensor::{anisotropy, tangent};
use crate::kernels::simd::pixels::{Block, fetch4, for_blocks, offsets, write};
use crate::kernels::smoothing::line_integral_convolution::{Adapt, Options, least_turn};
use isophote_engine::fearless_simd::prelude::*;
use isophote_engine::fearless_simd::{Simd, dispatch, f32x8};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance, View};

crate::kernel!(cabral_leedom {
    cpu: run,
    cost: |p| 2.0 * 1.3 * f64::from(half_length(p.sigma)) * 120.0 + 60.0,
    tolerance: Tolerance {
        absolute: 2e-3,
        relative: 1e-3,
        outliers: 0.02,
        reason: "where a line meets a corner, or two opposite tangents are equally near, the last bit \
                 decides which pixels it takes, and one such pixel is a large share of a small picture",
    },
});

/// Smooths a colour along the stream lines of `tensors`; pixels count by their coverage. Steps are those
/// of the pixels: `options.step` and `options.midpoint` have no part in it.
pub fn pass(plan: &mut PlanBuilder, color: ImageId, tensors: ImageId, options: &Options) -> ImageId {
    let params = Params {
        sigma: options.sigma,
        least_turn: least_turn(options.max_angle),
        adapt: options.adapt as u32,
    };
    plan.pass(&KERNEL, &[color, tensors], &params, Class::Colour, Support::Pixels(reach(&params) as u32))
}

/// No pixel lies farther than the line is long; adaptation only shortens it.
fn reach(params: &Params) -> i32 {
    half_length(params.sigma) as i32 + 1
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    let covered = Covered::new(&pass.inputs[0], band, reach(&params));
    let source = covered.view(&pass.inputs[0]);
    dispatch!(pass.level, simd => for_blocks::<4>(
        band,
        #[inline(always)]
        |block, target| write(convolved(simd, &params, &source, &pass.inputs[1], &block), target),
    ));
}

#[inline(always)]
fn convolved<S: Simd>(
    simd: S,
    params: &Params,
    source: &View<'_>,
    tensors: &View<'_>,
    block: &Block,
) -> [f32x8<S>; 4] {
    let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
    let [e, f, g, _] = block.read(simd, tensors);
    let mut sigma = zero + params.sigma;
    if params.adapt == Adapt::Anisotropy as u32 {
        let a = anisotropy(e, f, g) + 1.0;
        sigma *= a * a * 0.25;
    }
    let limit = (sigma * 2.0 + 1e-3).floor();
    let lines = GaussianLines {
        sigma,
        limit,
        most_steps: most_steps(2.0 * params.sigma),
        least_turn: params.least_turn,
        turns_count: params.adapt == Adapt::Angle as u32,
    };
    let [tx, ty] = tangent(e, f, g);
    // A line of no length is the pixel itself.
    let mut norm = limit.simd_le(zero).select(one, zero);
    let mut sum = block.read(simd, source);
    for c in 0..4 {
        sum[c] *= norm;
    }
    for side in [-1.0, 1.0] {
        lines.trace(
            simd,
            tensors,
            block.centres(simd),
            [tx * side, ty * side],
            #[inline(always)]
            |[x, y], weight| {
                let tap = fetch4(simd, source, offsets(source, x, y));
                for c in 0..4 {
                    sum[c] = weight.mul_add(tap[c], sum[c]);
                }
                norm += weight;
            },
        );
    }
    let [r, g, b, alpha] = unpremultiply(sum);
    [r, g, b, alpha / norm.at_least(1e-6)]
}
