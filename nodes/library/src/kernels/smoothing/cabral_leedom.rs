//! Line integral convolution of a colour with a Gaussian along stream lines after Cabral and Leedom
//! (§ 2.9.4): image and field are constant on pixels, and the Gaussian is integrated exactly (2.193).
//!
//! Cost: up to 6 sigma segments per pixel, each one colour and one tensor with its tangent, two divisions
//! and the error function, about 120 operations.

pub use crate::kernels::shaders::cabral_leedom::Params;
use crate::kernels::shared::coverage::Covered;
use crate::kernels::shared::pixel_line::{PixelLine, error_function, most_steps};
use crate::kernels::shared::stream::acos;
use crate::kernels::shared::tensor::{anisotropy, tangent};
use crate::kernels::simd::pixels::{Block, fetch4, for_blocks, offsets, unpremultiply, write};
use crate::kernels::smoothing::line_integral_convolution::{Adapt, Options, least_turn};
use isophote_engine::fearless_simd::{Simd, dispatch, f32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance, View};

crate::kernel!(cabral_leedom {
    cpu: run,
    cost: |params| {
        let p: Params = bytemuck::pod_read_unaligned(params);
        2.0 * 1.3 * f64::from(radius(p.sigma)) * 120.0 + 60.0
    },
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
pub fn color(plan: &mut PlanBuilder, color: ImageId, tensors: ImageId, options: &Options) -> ImageId {
    let params = Params {
        sigma: options.sigma,
        least_turn: least_turn(options.max_angle),
        adapt: options.adapt as u32,
    };
    // No pixel farther than the line is long; adaptation only shortens it.
    plan.pass(
        &KERNEL,
        &[color, tensors],
        &params,
        Class::Colour,
        Support::Pixels(radius(params.sigma) as u32 + 1),
    )
}

/// L = floor(2 sigma) (§ 2.9.3); a last bit must not decide whether a whole number is reached.
fn radius(sigma: f32) -> f32 {
    (2.0 * sigma + 1e-3).floor()
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    let covered = Covered::new(&pass.inputs[0], band, radius(params.sigma) as i32 + 1);
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
    let steps = most_steps(2.0 * params.sigma);
    // 1 / (sigma sqrt 2).
    let inverse = f32x8::splat(simd, std::f32::consts::FRAC_1_SQRT_2) / sigma.max(1e-3);
    let [tx, ty] = tangent(e, f, g);

    let [x, y] = block.centres(simd);
    // A line of no length is the pixel itself.
    let mut norm = limit.simd_le(zero).select(one, zero);
    let mut sum: [f32x8<S>; 4] = block.read(simd, source);
    for value in &mut sum {
        *value *= norm;
    }
    for side in [-1.0, 1.0] {
        let mut line = PixelLine::begin(x, y, [tx * side, ty * side]);
        let mut u = zero;
        let mut passed = zero;
        let mut active = u.simd_lt(limit);
        for _ in 0..steps {
            if !active.any_true() {
                break;
            }
            let h = line.aim(simd, tensors);
            active &= line.turn.simd_ge(f32x8::splat(simd, params.least_turn));
            if params.adapt == Adapt::Angle as u32 {
                // What the turn adds to the arc length lies between two segments.
                u += (acos(line.turn) * limit / std::f32::consts::PI - h).max(zero);
                passed = error_function(u * inverse);
            }
            let end = (u + h).min(limit);
            let reached = error_function(end * inverse);
            let weight = active.select((reached - passed).max(zero), zero);
            let [px, py] = line.pixels();
            let tap = fetch4(simd, source, offsets(source, px, py));
            for (sum, tap) in sum.iter_mut().zip(tap) {
                *sum = weight.mul_add(tap, *sum);
            }
            norm += weight;
            (u, passed) = (end, reached);
            active &= u.simd_lt(limit);
            active = line.cross(tensors, h, active);
        }
    }
    let [r, g, b, alpha] = unpremultiply(sum);
    [r, g, b, alpha / norm.max(1e-6)]
}
