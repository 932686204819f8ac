//! Line integral convolution of a colour with a Gaussian along the stream lines of a tensor field
//! (2.186, 2.187), with the length adapted to the anisotropy (§ 6.3.1) or to the curvature (§ 6.3.2).
//!
//! Cost: 4 sigma / h steps per pixel, each one bilinear colour sample and one (Euler) or two tensor
//! samples with their tangents, about 130 operations.

use crate::kernels::blocks::{BLOCK, TILE};
use crate::kernels::coverage::Covered;
use crate::kernels::stream_line::{Stream, StreamField, acos, centres};
use crate::kernels::lines::orientation_field;
use crate::kernels::support::{get_pixels4, put_pixels4};
use crate::kernels::tensor_algebra::{anisotropy, tangent};
use isophote_engine::fearless_simd::{Simd, dispatch, f32x8, i32x8, prelude::*};
use isophote_engine::math::{Elementary, InnerPlace, load4, sample_linear4};
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
    dispatch!(pass.level, simd => lines.fill(simd, band));
}

/// What all blocks of a band share.
struct Lines<'a> {
    params: Params,
    /// Colours times coverage.
    source: View<'a>,
    tensors: View<'a>,
    field: StreamField<'a>,
}

/// Steps between two visits to the colours: no more than the usual lines have.
const RUN: usize = 12;

/// Steps of four times eight lines, two blocks with two sides each, whose colours are not added up yet.
///
/// First to trace and then to add up keeps the long chains of the one, where everything waits, from the
/// many independent loads of the other, and both in registers.
struct Taps {
    /// Where the pixels around a tap begin in the colours: by line, step and pixel.
    at: [[[i32; BLOCK]; RUN]; 4],
    /// Weights of the row above the tap.
    above: [[[f32; BLOCK]; RUN]; 4],
    /// Weights of the row below.
    below: [[[f32; BLOCK]; RUN]; 4],
    /// Shares of the column to the right.
    right: [[[f32; BLOCK]; RUN]; 4],
}

/// The lines of eight pixels: how long they are and how their weights fall off.
#[derive(Clone, Copy)]
struct Reach<S: Simd> {
    radius: f32x8<S>,
    limit: f32x8<S>,
    falloff: f32x8<S>,
}

impl<S: Simd> Reach<S> {
    /// The weights at arc length `u`.
    #[inline(always)]
    fn weight(&self, u: f32x8<S>) -> f32x8<S> {
        (self.falloff * u * u).exp2()
    }
}

impl Lines<'_> {
    /// Which of two ways a pixel takes depends on where it lies in the picture, not on its tile.
    #[inline(always)]
    fn fill<S: Simd>(&self, simd: S, band: &mut Band<'_>) {
        let (window, inner) = (band.window, self.field.inner(radius(self.params.sigma) as i32));
        let zeros = [[[0.0; BLOCK]; RUN]; 4];
        let mut taps = Taps { at: [[[0; BLOCK]; RUN]; 4], above: zeros, below: zeros, right: zeros };
        for start in (window.x0..window.x1).step_by(TILE as usize) {
            let end = (start + TILE).min(window.x1);
            for y in window.y0..window.y1 {
                let row = &mut band.row_mut(0, y)[4 * (start - window.x0) as usize..4 * (end - window.x0) as usize];
                let (mut from, mut to) = (inner.x0.clamp(start, end), inner.x1.clamp(start, end));
                if y < inner.y0 || y >= inner.y1 || to <= from {
                    (from, to) = (end, end);
                }
                let (left, rest) = row.split_at_mut(4 * (from - start) as usize);
                let (middle, right) = rest.split_at_mut(4 * (to - from) as usize);
                for (x, target) in (start..).step_by(BLOCK).zip(left.chunks_mut(4 * BLOCK)) {
                    put_pixels4(self.clamped(simd, x, y, from - 1), target);
                }
                for (x, target) in (from..).step_by(2 * BLOCK).zip(middle.chunks_mut(8 * BLOCK)) {
                    self.inner(simd, &mut taps, [x, y], to - 1, target);
                }
                for (x, target) in (to..).step_by(BLOCK).zip(right.chunks_mut(4 * BLOCK)) {
                    put_pixels4(self.clamped(simd, x, y, end - 1), target);
                }
            }
        }
    }

    /// The lengths of lines through pixels with the tensors (e, f, g).
    #[inline(always)]
    fn reach<S: Simd>(&self, e: f32x8<S>, f: f32x8<S>, g: f32x8<S>) -> Reach<S> {
        let mut sigma = f32x8::splat(e.simd, self.params.sigma);
        if self.params.adapt == Adapt::Anisotropy as u32 {
            let a = anisotropy(e, f, g) + 1.0;
            sigma *= a * a * 0.25;
        }
        let radius = (sigma * 2.0 + 1e-3).floor();
        let falloff = f32x8::splat(e.simd, -0.721_347_52) / (sigma * sigma).max(f32x8::splat(e.simd, 1e-6));
        Reach { radius, limit: radius + 1e-3, falloff }
    }

    /// Arc length of the last step of a line.
    #[inline(always)]
    fn arc<S: Simd>(&self, line: &Stream<S>, reach: &Reach<S>) -> f32x8<S> {
        let step = f32x8::splat(line.x.simd, self.params.step);
        if self.params.adapt == Adapt::Angle as u32 {
            return step.max(acos(line.turn) * reach.radius / std::f32::consts::PI);
        }
        step
    }

    /// Up to sixteen inner pixels from (x, y) on, none behind column `last`.
    #[inline(always)]
    fn inner<S: Simd>(&self, simd: S, taps: &mut Taps, [x, y]: [i32; 2], last: i32, target: &mut [f32]) {
        let (params, field) = (&self.params, &self.field);
        let (zero, step) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, params.step));
        let least_turn = f32x8::splat(simd, params.least_turn);
        let turns_count = params.adapt == Adapt::Angle as u32;
        let begun = [self.begun(simd, x, y, last), self.begun(simd, x + BLOCK as i32, y, last)];
        let [(near, [a, b]), (far, [c, d])] = begun;
        let (reach, mut lines) = ([near, far], [a, b, c, d]);
        let mut places = [InnerPlace::new(a.x, a.y); 4];
        let mut here = [[zero; 2]; 4];
        let mut active = [step.simd_le(near.limit), step.simd_le(near.limit), step.simd_le(far.limit), step.simd_le(far.limit)];
        let mut u = [zero; 4];
        let mut norm = [zero + 1.0; 2];
        let mut sums = [[zero; 2]; 2 * BLOCK];
        let mut begins = true;
        while (active[0] | active[1] | active[2] | active[3]).any_true() {
            let mut counts = [i32x8::splat(simd, 0); 2];
            for k in 0..RUN {
                if !begins {
                    for i in 0..4 {
                        here[i] = field.at_inner(simd, &places[i]);
                    }
                }
                begins = false;
                field.advance_inner(simd, &mut lines, &here);
                let mut weights = [zero; 4];
                for i in 0..4 {
                    // Both sides have come equally far unless turns count.
                    if i % 2 == 1 && !turns_count {
                        (u[i], weights[i]) = (u[i - 1], weights[i - 1]);
                        continue;
                    }
                    u[i] += self.arc(&lines[i], &reach[i / 2]);
                    weights[i] = reach[i / 2].weight(u[i]);
                }
                for i in 0..4 {
                    // Lines that have ended go on, where there is no edge to stop them; they have no weight.
                    active[i] &= u[i].simd_le(reach[i / 2].limit) & lines[i].turn.simd_ge(least_turn);
                    let weight = active[i].select(weights[i], zero);
                    norm[i / 2] += weight;
                    places[i] = InnerPlace::new(lines[i].x, lines[i].y);
                    let below = weight * places[i].below;
                    taps.at[i][k] = places[i].offsets(&self.source);
                    (weight - below).store_slice(&mut taps.above[i][k]);
                    below.store_slice(&mut taps.below[i][k]);
                    places[i].right.store_slice(&mut taps.right[i][k]);
                }
                for i in 0..2 {
                    let either = active[2 * i] | active[2 * i + 1];
                    counts[i] = either.select(i32x8::splat(simd, k as i32 + 1), counts[i]);
                }
                for i in 0..4 {
                    active[i] &= (u[i] + step).simd_le(reach[i / 2].limit);
                }
                if !(active[0] | active[1] | active[2] | active[3]).any_true() {
                    break;
                }
            }
            for i in 0..2 {
                let counts = counts[i].to_array();
                for lane in 0..BLOCK {
                    self.add(simd, taps, 2 * i, lane, counts[lane] as usize, &mut sums[i * BLOCK + lane]);
                }
            }
        }
        for i in 0..2 {
            if let Some(target) = target.get_mut(32 * i..) && !target.is_empty() {
                let mut colors = [0.0; 4 * BLOCK];
                for (color, [all, right]) in colors.chunks_exact_mut(4).zip(&sums[i * BLOCK..]) {
                    let ((all, _), (left, right)) = (all.split(), right.split());
                    (all - left + right).store_slice(color);
                }
                let mut sum = load4(simd, &colors);
                let centre = get_pixels4(simd, &self.source, x + (i * BLOCK) as i32, y, last);
                for c in 0..4 {
                    sum[c] += centre[c];
                }
                let len = target.len().min(4 * BLOCK);
                put_pixels4(mean(sum, norm[i]), &mut target[..len]);
            }
        }
    }

    /// Adds up `count` steps to both sides of one pixel: the sums of left and right pixels, and the same times
    /// the shares of the right ones. The left ones' shares are what is missing to one.
    #[inline(always)]
    fn add<S: Simd>(&self, simd: S, taps: &Taps, first: usize, lane: usize, count: usize, sums: &mut [f32x8<S>; 2]) {
        let (data, stride) = (self.source.data(), self.source.stride() as u32 as usize);
        // Two slices of one length share the check of the range.
        let (upper, lower) = (&data[..data.len() - stride], &data[stride..]);
        let mut sides = [*sums, [f32x8::splat(simd, 0.0); 2]];
        for k in 0..count.min(RUN) {
            for (side, [all, right]) in sides.iter_mut().enumerate() {
                let line = first + side;
                let at = taps.at[line][k][lane] as u32 as usize;
                let above = f32x8::from_slice(simd, &upper[at..at + 8]) * taps.above[line][k][lane];
                let below = f32x8::splat(simd, taps.below[line][k][lane]);
                let pair = f32x8::from_slice(simd, &lower[at..at + 8]).mul_add(below, above);
                *all += pair;
                *right = pair.mul_add(f32x8::splat(simd, taps.right[line][k][lane]), *right);
            }
        }
        *sums = [sides[0][0] + sides[1][0], sides[0][1] + sides[1][1]];
    }

    /// Both sides of the lines through a block.
    #[inline(always)]
    fn begun<S: Simd>(&self, simd: S, x: i32, y: i32, last: i32) -> (Reach<S>, [Stream<S>; 2]) {
        let [e, f, g, _] = get_pixels4(simd, &self.tensors, x, y, last);
        let [px, py] = centres(simd, x, y, last);
        (self.reach(e, f, g), Stream::both_sides(px, py, tangent(e, f, g)))
    }

    /// Up to eight pixels anywhere.
    #[inline(always)]
    fn clamped<S: Simd>(&self, simd: S, x: i32, y: i32, last: i32) -> [f32x8<S>; 4] {
        let (params, field) = (&self.params, &self.field);
        let (zero, step) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, params.step));
        let (reach, mut lines) = self.begun(simd, x, y, last);
        let mut sum = get_pixels4(simd, &self.source, x, y, last);
        let mut norm = f32x8::splat(simd, 1.0);
        let mut u = [zero; 2];
        let mut active = [step.simd_le(reach.limit); 2];
        while (active[0] | active[1]).any_true() {
            field.advance_both(simd, &mut lines, active);
            for side in 0..2 {
                let line = &lines[side];
                u[side] += self.arc(line, &reach);
                active[side] &= u[side].simd_le(reach.limit) & field.inside(simd, line);
                active[side] &= line.turn.simd_ge(f32x8::splat(simd, params.least_turn));
                let weight = active[side].select(reach.weight(u[side]), zero);
                let [r, g, b, a] = sample_linear4(simd, &self.source, line.x, line.y);
                sum = [
                    weight.mul_add(r, sum[0]),
                    weight.mul_add(g, sum[1]),
                    weight.mul_add(b, sum[2]),
                    weight.mul_add(a, sum[3]),
                ];
                norm += weight;
                active[side] &= (u[side] + step).simd_le(reach.limit);
            }
        }
        mean(sum, norm)
    }
}

/// The colour and coverage of weighted sums of covered colours and of coverage.
#[inline(always)]
fn mean<S: Simd>([r, g, b, alpha]: [f32x8<S>; 4], norm: f32x8<S>) -> [f32x8<S>; 4] {
    let zero = f32x8::splat(norm.simd, 0.0);
    let seen = alpha.simd_gt(f32x8::splat(norm.simd, 1e-6));
    [seen.select(r / alpha, zero), seen.select(g / alpha, zero), seen.select(b / alpha, zero), alpha / norm]
}
