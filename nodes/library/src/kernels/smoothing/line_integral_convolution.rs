//! Line integral convolution of a colour with a Gaussian along the stream lines of a tensor field
//! (2.186, 2.187), with the length adapted to the anisotropy (§ 6.3.1) or to the curvature (§ 6.3.2).
//!
//! Cost: 4 sigma / h steps per pixel, each one bilinear colour sample and one (Euler) or two tensor
//! samples with their tangents, about 130 operations.

use crate::kernels::blocks::for_blocks_in_tiles;
use crate::kernels::coverage::Covered;
use crate::kernels::stream_line::{Stream, StreamField, acos, centres};
use crate::kernels::lines::orientation_field;
use crate::kernels::support::{get_pixels4, put_pixels4};
use crate::kernels::tensor_algebra::{anisotropy, tangent};
use isophote_engine::fearless_simd::{Simd, dispatch, f32x8, prelude::*};
use isophote_engine::math::{Elementary, InnerPlace, sample_inner4, sample_linear4};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance, View};

crate::params! {
    /// Uniform block.
    pub struct Params for line_integral_convolution {
        /// Standard deviation along the line, pixels.
        pub sigma: f32,
        /// Step size h, pixels.
        pub step: f32,
        /// A side ends at a step that turns by more than the angle of this cosine.
        pub least_turn: f32,
        /// 1: second-order Runge-Kutta; 0: Euler.
        pub midpoint: u32,
        /// 0: none; 1: anisotropy; 2: angle.
        pub adapt: u32,
    }
}

crate::kernel!(line_integral_convolution {
    cpu: run,
    cost: |params| {
        let p: Params = bytemuck::pod_read_unaligned(params);
        let steps = 2.0 * f64::from(radius(p.sigma)) / f64::from(p.step);
        steps * if p.midpoint != 0 { 130.0 } else { 80.0 }
    },
    tolerance: Tolerance {
        absolute: 2e-3,
        relative: 1e-3,
        outliers: 0.02,
        reason: "stream lines add up roundings; where the field is undetermined, or a line ends at a \
                 whole number of pixels, the last bit decides where it goes, and one such pixel is a \
                 large share of a small picture",
    },
});

/// How the length of the lines is adapted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Adapt {
    /// Not at all.
    None = 0,
    /// sigma (1 + A)^2 / 4, A the anisotropy at the centre (§ 6.3.1).
    Anisotropy = 1,
    /// The arc length runs faster where the line turns (§ 6.3.2).
    Angle = 2,
}

/// What a convolution is asked for.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Standard deviation along the line, pixels.
    pub sigma: f32,
    /// Step size h, pixels.
    pub step: f32,
    /// Second-order Runge-Kutta instead of Euler.
    pub midpoint: bool,
    /// How the length is adapted.
    pub adapt: Adapt,
    /// A side ends at a step that turns by more, degrees; 0 for never.
    pub max_angle: f32,
}

impl Default for Options {
    fn default() -> Self {
        Self { sigma: 6.0, step: 1.0, midpoint: true, adapt: Adapt::Anisotropy, max_angle: 0.0 }
    }
}

/// Smooths a colour along the stream lines of `tensors`; pixels count by their coverage.
pub fn color(plan: &mut PlanBuilder, color: ImageId, tensors: ImageId, options: &Options) -> ImageId {
    let params = Params {
        sigma: options.sigma,
        step: options.step.max(MIN_STEP),
        least_turn: least_turn(options.max_angle),
        midpoint: u32::from(options.midpoint),
        adapt: options.adapt as u32,
    };
    let field = orientation_field::of_tensor(plan, tensors);
    plan.pass(&KERNEL, &[color, tensors, field], &params, Class::Colour, support(&params))
}

/// Cosine of the greatest turn that a line survives, `max_angle` degrees; 0 for any.
pub(crate) fn least_turn(max_angle: f32) -> f32 {
    if max_angle > 0.0 { max_angle.to_radians().cos() } else { -1.0 }
}

/// Shorter steps cost much and gain nothing over rounding.
const MIN_STEP: f32 = 0.1;

/// L = floor(2 sigma) (§ 2.9.3); a last bit must not decide whether a whole number is reached.
fn radius(sigma: f32) -> f32 {
    (2.0 * sigma + 1e-3).floor()
}

/// Adaptation only shortens lines; a bilinear sample at distance L reads one pixel further.
fn support(params: &Params) -> Support {
    Support::Pixels(radius(params.sigma) as u32 + 1)
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    let covered = Covered::new(&pass.inputs[0], band, radius(params.sigma) as i32 + 1);
    let lines = Lines {
        params,
        source: covered.view(&pass.inputs[0]),
        tensors: pass.inputs[1],
        field: StreamField { tensors: pass.inputs[2], step: params.step, midpoint: params.midpoint != 0 },
    };
    let last = band.window.x1 - 1;
    dispatch!(pass.level, simd => for_blocks_in_tiles::<4>(band, #[inline(always)] |block, target| {
        put_pixels4(lines.convolved(simd, block.x, block.y, last), target);
    }));
}

/// What all blocks of a band share.
struct Lines<'a> {
    params: Params,
    /// Colours times coverage.
    source: View<'a>,
    tensors: View<'a>,
    field: StreamField<'a>,
}

impl Lines<'_> {
    #[inline(always)]
    fn convolved<S: Simd>(&self, simd: S, x: i32, y: i32, last: i32) -> [f32x8<S>; 4] {
        let (params, field) = (&self.params, &self.field);
        let [e, f, g, _] = get_pixels4(simd, &self.tensors, x, y, last);
        let mut sigma = f32x8::splat(simd, params.sigma);
        if params.adapt == Adapt::Anisotropy as u32 {
            let a = anisotropy(e, f, g) + 1.0;
            sigma *= a * a * 0.25;
        }
        let radius = (sigma * 2.0 + 1e-3).floor();
        let limit = radius + 1e-3;
        let falloff = f32x8::splat(simd, -0.721_347_52) / (sigma * sigma).max(f32x8::splat(simd, 1e-6));
        let step = f32x8::splat(simd, params.step);

        let zero = f32x8::splat(simd, 0.0);
        let mut sum = get_pixels4(simd, &self.source, x, y, last);
        let mut norm = f32x8::splat(simd, 1.0);
        let [px, py] = centres(simd, x, y, last);
        let mut lines = Stream::both_sides(px, py, tangent(e, f, g));
        let mut t = [lines[0].direction, lines[1].direction];
        let mut u = [zero; 2];
        let mut active = [step.simd_le(limit); 2];
        // Lines that have ended go on where there is no edge to stop them; they have no weight.
        let inner = field.is_inner(x, y, 8, self::radius(params.sigma) as i32);
        while (active[0] | active[1]).any_true() {
            if inner {
                field.advance_inner(simd, &mut lines, t);
            } else {
                field.advance_both(simd, &mut lines, active);
            }
            for side in 0..2 {
                let line = &lines[side];
                let mut du = step;
                if params.adapt == Adapt::Angle as u32 {
                    du = du.max(acos(line.turn) * radius / std::f32::consts::PI);
                }
                u[side] += du;
                active[side] &= u[side].simd_le(limit);
                if !inner {
                    active[side] &= field.inside(simd, line);
                }
                active[side] &= line.turn.simd_ge(f32x8::splat(simd, params.least_turn));
                let weight = active[side].select((falloff * u[side] * u[side]).exp2(), zero);
                let [r, g, b, a] = if inner {
                    let place = InnerPlace::new(line.x, line.y);
                    t[side] = field.tangent_at(simd, &place);
                    sample_inner4(simd, &self.source, &place)
                } else {
                    sample_linear4(simd, &self.source, line.x, line.y)
                };
                sum = [
                    weight.mul_add(r, sum[0]),
                    weight.mul_add(g, sum[1]),
                    weight.mul_add(b, sum[2]),
                    weight.mul_add(a, sum[3]),
                ];
                norm += weight;
                active[side] &= (u[side] + step).simd_le(limit);
            }
        }
        let [r, g, b, alpha] = sum;
        let seen = alpha.simd_gt(f32x8::splat(simd, 1e-6));
        [seen.select(r / alpha, zero), seen.select(g / alpha, zero), seen.select(b / alpha, zero), alpha / norm]
    }
}
