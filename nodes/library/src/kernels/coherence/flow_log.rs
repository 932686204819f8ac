//! The flow-based Laplacian of Gaussian (§ 6.4.3, Listing 6.1): the scale-normalised second derivative
//! of a Gaussian of the luma along the major eigenvector, negative about maxima and positive about
//! minima. Taps are one pixel apart on the nearer axis; their sum is multiplied by the step, so that
//! diagonals respond alike.
//!
//! The weights sum to zero, as those of a derivative should: taps count as differences to the centre.
//! As far as a tap is transparent it stands for the centre.
//!
//! Cost: 5 sigma steps, each one linear interpolation between sums of opposite pixels and about 20 operations.

use crate::kernels::blocks::{BLOCK, Block, write1};
use crate::kernels::luma_lines::{Line, LumaLines, STRIP};
use crate::kernels::tensor_algebra::axis;
use isophote_engine::fearless_simd::{Simd, dispatch, f32x8, prelude::*};
use isophote_engine::math::Elementary;
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Rect, Support, Tolerance};

crate::params! {
    /// Uniform block.
    pub struct Params for flow_log {
        /// Standard deviation, pixels.
        pub sigma: f32,
        /// Distance of the last tap, pixels.
        pub reach: f32,
    }
}

crate::kernel!(flow_log {
    cpu: run,
    cost: |params| {
        let p: Params = bytemuck::pod_read_unaligned(params);
        40.0 + 50.0 * f64::from(p.reach)
    },
    tolerance: Tolerance {
        absolute: 1e-4,
        relative: 1e-4,
        outliers: 1e-3,
        reason: "the Gaussian is carried from tap to tap and its taps nearly cancel, in HDR from 40 times \
                 the unit; a direction on the diagonal or a last tap at \
                 a whole number of steps is decided by the last bit",
    },
});

/// Distance of the last tap in standard deviations (Listing 6.1).
const CUTOFF: f32 = 5.0;

/// Narrower Gaussians than this see no neighbour.
const LEAST_SIGMA: f32 = 0.2;

/// The response to the luma of `color` along the major eigenvectors of `tensors`, in the unit of luma.
pub fn response(plan: &mut PlanBuilder, color: ImageId, tensors: ImageId, sigma: f32) -> ImageId {
    let sigma = sigma.max(LEAST_SIGMA);
    let params = Params { sigma, reach: CUTOFF * sigma };
    plan.pass(&KERNEL, &[color, tensors], &params, Class::Field, Support::Pixels(steps(&params) as u32))
}

/// Most steps to a side.
fn steps(params: &Params) -> i32 {
    (params.reach + 1e-3) as i32
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    let radius = steps(&params);
    dispatch!(pass.level, simd => strips(simd, pass, &params, radius, band));
}

#[inline(always)]
fn strips<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, radius: i32, band: &mut Band<'_>) {
    let window = band.window;
    let mut lumas = LumaLines::default();
    for x0 in (window.x0..window.x1).step_by(STRIP as usize) {
        let strip = Rect { x0, x1: (x0 + STRIP).min(window.x1), ..window };
        lumas.load(simd, &pass.inputs[0], strip, radius, true);
        for y in window.y0..window.y1 {
            let (start, end) = ((x0 - window.x0) as usize, (strip.x1 - window.x0) as usize);
            let row = &mut band.row_mut(0, y)[start..end];
            for i in (0..end - start).step_by(BLOCK) {
                let block = Block { x: x0 + i as i32, y, len: BLOCK.min(end - start - i) };
                let response = if lumas.is_opaque() {
                    along::<_, true>(simd, pass, params, radius, &lumas, block)
                } else {
                    along::<_, false>(simd, pass, params, radius, &lumas, block)
                };
                write1(response, &mut row[i..i + block.len]);
            }
        }
    }
}

#[inline(always)]
fn along<S: Simd, const OPAQUE: bool>(
    simd: S,
    pass: &CpuPass<'_>,
    params: &Params,
    radius: i32,
    lumas: &LumaLines,
    block: Block,
) -> f32x8<S> {
    let [e, f, g, _] = block.read4(simd, &pass.inputs[1]);
    let (_, n) = axis((e - g) * 0.5, f);
    let line = lumas.line(simd, block.x, block.y, n);
    let step = f32x8::splat(simd, 1.0) / line.major_share;
    let steps = (line.major_share * (params.reach + 1e-3)).floor();
    let mut centre = lumas.centre(simd, block.x, block.y);
    if !OPAQUE {
        let alpha = lumas.coverage(simd, block.x, block.y);
        let seen = alpha.simd_gt(f32x8::splat(simd, 1e-6));
        centre = seen.select(centre / alpha, f32x8::splat(simd, 0.0));
    }
    let variance = params.sigma * params.sigma;
    // exp(-d^2 / 2 sigma^2) at d = k step, from one step to the next.
    let falloff = (step * step * (-0.721_347_52 / variance)).exp2();
    let taps = Taps { lumas, line, step, steps, centre, variance, falloff, radius };
    let sum = match line.rows() {
        1 => taps.sum::<OPAQUE, 1>(simd),
        2 => taps.sum::<OPAQUE, 2>(simd),
        3 => taps.sum::<OPAQUE, 3>(simd),
        _ => taps.sum::<OPAQUE, 0>(simd),
    };
    sum * step / (2.506_628_3 * variance * params.sigma)
}

/// What the taps of eight pixels are.
struct Taps<'a, S: Simd> {
    lumas: &'a LumaLines,
    line: Line<S>,
    /// Pixels from tap to tap.
    step: f32x8<S>,
    /// Taps to a side.
    steps: f32x8<S>,
    centre: f32x8<S>,
    variance: f32,
    /// exp(-step^2 / 2 sigma^2).
    falloff: f32x8<S>,
    /// Most taps to a side.
    radius: i32,
}

impl<S: Simd> Taps<'_, S> {
    /// Their weighted sum; `ROWS` is how the line is read.
    #[inline(always)]
    fn sum<const OPAQUE: bool, const ROWS: usize>(&self, simd: S) -> f32x8<S> {
        let Self { lumas, ref line, step, steps, centre, variance, falloff, radius } = *self;
        // The Gaussian is carried from one step to the next.
        let (mut gaussian, mut ratio) = (falloff, falloff * falloff * falloff);
        let mut sum = f32x8::splat(simd, 0.0);
        for k in 1..=radius {
            let active = steps.simd_ge(f32x8::splat(simd, k as f32));
            if !active.any_true() {
                break;
            }
            let d = step * k as f32;
            let across = line.slope * k as f32;
            // Opposite taps lie alike between their neighbours.
            let i = across.floor();
            let share = across - i;
            let [a, b] = lumas.opposite_pairs::<_, ROWS>(simd, line, k, i.to_int());
            let taps = (b - a).mul_add(share, a);
            let mut coverage = f32x8::splat(simd, 2.0);
            if !OPAQUE {
                let [a, b] = lumas.opposite_coverage::<_, ROWS>(simd, line, k, i.to_int());
                coverage = (b - a).mul_add(share, a);
            }
            let both = taps - coverage * centre;
            let weight = active.select((d * d - variance) * gaussian, f32x8::splat(simd, 0.0));
            sum = weight.mul_add(both, sum);
            gaussian *= ratio;
            ratio *= falloff * falloff;
        }
        sum
    }
}
