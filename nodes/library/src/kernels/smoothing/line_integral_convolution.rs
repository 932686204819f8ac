//! Line integral convolution of a colour with a Gaussian along the stream lines of a tensor field
//! (2.186, 2.187), with the length adapted to the anisotropy (§ 6.3.1) or to the curvature (§ 6.3.2).
//!
//! Cost: 4 sigma / h steps per pixel, two fifths of it where steps are stretched, each one bilinear colour sample
//! and one (Euler, two-step) or two tensor samples with their tangents, about 90 or 130 operations.

use crate::kernels::lines::orientation_field;
pub use crate::kernels::shaders::line_integral_convolution::Params;
use crate::kernels::shared::coverage::{Covered, full_or};
use crate::kernels::shared::sampling::sample_linear4;
use crate::kernels::shared::stream::{
    FEW_STEPS, Integrator, NearField, Stream, StreamField, acos, few_steps, holds, stretched,
};
use crate::kernels::shared::tensor::{anisotropy, tangent};
use crate::kernels::simd::pixels::{BLOCK, Block, for_blocks_in_tiles, write};
use crate::kernels::simd::tile_copy::{FOUR, Frame, Place, Surroundings, TWO};
use isophote_engine::fearless_simd::{Simd, dispatch, f32x8, i32x8, prelude::*};
use isophote_engine::math::{Elementary, load4};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance, View};

crate::kernel!(line_integral_convolution {
    cpu: run,
    cost: |params| {
        let p: Params = bytemuck::pod_read_unaligned(params);
        let steps = 2.0 * f64::from(radius(p.sigma)) / f64::from(p.step * p.stretch);
        steps * if p.integrator == Integrator::Midpoint as u32 { 130.0 } else { 80.0 }
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

crate::choice::choice! {
    /// How the length of the lines is adapted.
    pub enum Adapt {
        /// Not at all.
        None = 0 ("none", "Off"),
        /// sigma (1 + A)^2 / 4, A the anisotropy at the centre (§ 6.3.1).
        Anisotropy = 1 ("anisotropy", "By anisotropy"),
        /// The arc length runs faster where the line turns (§ 6.3.2).
        Angle = 2 ("angle", "By turning angle"),
    }
}

/// What a convolution is asked for.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Standard deviation along the line, pixels.
    pub sigma: f32,
    /// Step size h, pixels.
    pub step: f32,
    /// Most by which steps may be stretched ([`few_steps`]), at least 1.
    pub stretch: f32,
    /// How the lines are stepped.
    pub integrator: Integrator,
    /// How the length is adapted.
    pub adapt: Adapt,
    /// A side ends at a step that turns by more, degrees; 0 for never.
    pub max_angle: f32,
}

/// Smooths a colour along the stream lines of `tensors`; pixels count by their coverage.
pub fn color(plan: &mut PlanBuilder, color: ImageId, tensors: ImageId, options: &Options) -> ImageId {
    let params = Params {
        sigma: options.sigma,
        step: options.step.max(MIN_STEP),
        // What has few steps at most need not work out how many they are.
        stretch: if radius(options.sigma) > FEW_STEPS * options.step { options.stretch } else { 1.0 },
        least_turn: least_turn(options.max_angle),
        integrator: options.integrator as u32,
        adapt: options.adapt as u32,
    };
    let field = orientation_field::of_tensor(plan, tensors);
    plan.pass(
        &KERNEL,
        &[color, tensors, field],
        &params,
        Class::Colour,
        Support::Pixels(reach(&params) as u32),
    )
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

/// The most pixels that are read to any side.
///
/// Adaptation only shortens lines; a bilinear sample at distance L reads one pixel further.
fn reach(params: &Params) -> i32 {
    radius(params.sigma) as i32 + 1
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    let reach = reach(&params);
    let lines = Lines { params, source: pass.inputs[0], tensors: pass.inputs[1], field: pass.inputs[2] };
    // Which of two ways is taken depends on the parameters alone, not on where a pixel's tile lies.
    if Frame::suits(reach) {
        let mut tile = Tile::default();
        for frame in Frame::tiles(band.window, reach) {
            match Integrator::of(params.integrator) {
                // Known to the compiler, the usual one has no part in its loops for what others need.
                Integrator::TwoStep => {
                    dispatch!(pass.level, simd => lines.fill(simd, Integrator::TwoStep, &frame, &mut tile, band));
                }
                other => dispatch!(pass.level, simd => lines.fill(simd, other, &frame, &mut tile, band)),
            }
        }
    } else {
        let covered = Covered::new(&lines.source, band, reach);
        dispatch!(pass.level, simd => lines.fill_far(simd, covered.view(&lines.source), band));
    }
}

/// What all blocks of a band share.
struct Lines<'a> {
    params: Params,
    source: View<'a>,
    tensors: View<'a>,
    field: View<'a>,
}

/// A tile and what lies around it.
#[derive(Default)]
struct Tile {
    colors: Surroundings<FOUR>,
    field: Surroundings<TWO>,
    taps: Box<Taps>,
}

/// Steps between two visits to the colours: no more than the usual lines have.
const RUN: usize = 12;

/// By line, step and pixel, for both sides of two blocks.
type PerTap<T> = [[[T; BLOCK]; RUN]; 4];

/// Steps of four times eight lines whose colours are not added up yet.
///
/// First to trace and then to add up keeps the long chains of the one, where everything waits, from the
/// many independent loads of the other, and both in registers.
#[derive(Default)]
struct Taps {
    /// The pixels above and to the left of a tap.
    at: PerTap<i32>,
    /// Weights of the row above the tap.
    above: PerTap<f32>,
    /// Weights of the row below.
    below: PerTap<f32>,
    /// Shares of the column to the right.
    right: PerTap<f32>,
}

/// The lines of eight pixels: how long they are and how their weights fall off.
#[derive(Clone, Copy)]
struct Reach<S: Simd> {
    radius: f32x8<S>,
    falloff: f32x8<S>,
    /// Length of their steps.
    step: f32x8<S>,
    /// Cosine of the most that they may turn in one of them.
    least_turn: f32x8<S>,
}

impl<S: Simd> Reach<S> {
    /// The arc length that the last step does not exceed.
    #[inline(always)]
    fn limit(&self) -> f32x8<S> {
        self.radius + 1e-3
    }

    /// The weights at arc length `u`.
    #[inline(always)]
    fn weight(&self, u: f32x8<S>) -> f32x8<S> {
        (self.falloff * u * u).exp2_falling()
    }
}

impl Lines<'_> {
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
        let one = f32x8::splat(e.simd, 1.0);
        if self.params.stretch <= 1.0 {
            let (step, least_turn) = (one * self.params.step, one * self.params.least_turn);
            return Reach { radius, falloff, step, least_turn };
        }
        let steps = ((radius + 1e-3) * self.params.step.recip()).floor();
        let stretch = stretched(steps, few_steps(steps, self.params.stretch));
        // The cosine of so many times the angle whose cosine is c, exact for one and two times; no more than c,
        // since -1 stands for any turn.
        let c = one * self.params.least_turn;
        let least_turn = c.min(one - stretch * ((one - c) * (one - c) + stretch * c * (one - c)));
        Reach { radius, falloff, step: stretch * self.params.step, least_turn }
    }

    /// Arc length of the last step of a line.
    #[inline(always)]
    fn arc<S: Simd>(&self, line: &Stream<S>, reach: &Reach<S>) -> f32x8<S> {
        if self.params.adapt == Adapt::Angle as u32 {
            return reach.step.max(acos(line.turn) * reach.radius / std::f32::consts::PI);
        }
        reach.step
    }

    /// One tile.
    #[inline(always)]
    fn fill<S: Simd>(
        &self,
        simd: S,
        integrator: Integrator,
        frame: &Frame,
        tile: &mut Tile,
        band: &mut Band<'_>,
    ) {
        let Tile { colors, field, taps } = tile;
        colors.load_covered(&self.source, frame);
        field.load(&self.field, frame);
        let near = NearField { frame, tensors: field, integrator };
        let edges = frame.meets_edges(self.source.full());
        let last = frame.tile.x1 - 1;
        let (start, end) =
            ((frame.tile.x0 - band.window.x0) as usize, (frame.tile.x1 - band.window.x0) as usize);
        for y in frame.tile.y0..frame.tile.y1 {
            let row = &mut band.row_mut(0, y)[4 * start..4 * end];
            for (i, target) in row.chunks_mut(8 * BLOCK).enumerate() {
                let x = frame.tile.x0 + (2 * BLOCK * i) as i32;
                let lines = [self.begun(simd, x, y, last), self.begun(simd, x + BLOCK as i32, y, last)];
                let (sums, norms) = self.follow(simd, &near, lines, edges, colors, taps);
                for (i, target) in target.chunks_mut(4 * BLOCK).enumerate() {
                    let mut sum = load4(simd, &sums[i]);
                    let [r, g, b, alpha] =
                        Block::until(last + 1, x + (i * BLOCK) as i32, y).read(simd, &self.source);
                    let centre = [r * alpha, g * alpha, b * alpha, alpha];
                    for c in 0..4 {
                        sum[c] += centre[c];
                    }
                    write(mean(sum, norms[i]), target);
                }
            }
        }
    }

    /// Follows both sides of the lines through two blocks; the sums of their weighted colours without those of the
    /// centres, and the sums of all weights.
    #[inline(always)]
    fn follow<S: Simd>(
        &self,
        simd: S,
        field: &NearField<'_>,
        [(near, [a, b]), (far, [c, d])]: [(Reach<S>, [Stream<S>; 2]); 2],
        edges: bool,
        colors: &Surroundings<FOUR>,
        taps: &mut Taps,
    ) -> ([[f32; 4 * BLOCK]; 2], [f32x8<S>; 2]) {
        let (params, zero) = (&self.params, f32x8::splat(simd, 0.0));
        let (reach, mut lines) = ([near, far], [a, b, c, d]);
        let turns_count = params.adapt == Adapt::Angle as u32;
        let (near, far) = (reach[0].step.simd_le(reach[0].limit()), reach[1].step.simd_le(reach[1].limit()));
        let mut active = [near, near, far, far];
        let mut places = [Place::new(field.frame, lines[0].x, lines[0].y); 4];
        let mut u = [zero; 4];
        let mut norm = [zero + 1.0; 2];
        let mut totals = [[zero; 2]; 2 * BLOCK];
        // Over equal steps the Gaussian is carried from one to the next.
        let (mut gaussian, mut ratio, mut growth) = ([zero; 2], [zero; 2], [zero; 2]);
        for i in 0..2 {
            gaussian[i] = reach[i].weight(reach[i].step);
            growth[i] = gaussian[i] * gaussian[i];
            ratio[i] = growth[i] * gaussian[i];
        }
        let mut begins = true;
        while (active[0] | active[1] | active[2] | active[3]).any_true() {
            let mut counts = [i32x8::splat(simd, 0); 2];
            if !begins && !turns_count {
                // Anew after a run: roundings would grow by the square of the number of steps.
                for i in 0..2 {
                    let (step, next) = (reach[i].step, u[2 * i] + reach[i].step);
                    gaussian[i] = reach[i].weight(next);
                    ratio[i] = (reach[i].falloff * step * (next + next + step)).exp2_falling();
                }
            }
            begins = false;
            for k in 0..RUN {
                field.advance(
                    simd,
                    &mut lines,
                    &places,
                    [reach[0].step, reach[0].step, reach[1].step, reach[1].step],
                );
                let mut weights = [zero; 4];
                for i in 0..2 {
                    // Both sides have come equally far unless turns count.
                    let (a, b) = (2 * i, 2 * i + 1);
                    if turns_count {
                        u[a] += self.arc(&lines[a], &reach[i]);
                        u[b] += self.arc(&lines[b], &reach[i]);
                        (weights[a], weights[b]) = (reach[i].weight(u[a]), reach[i].weight(u[b]));
                    } else {
                        u[a] += reach[i].step;
                        (u[b], weights[a], weights[b]) = (u[a], gaussian[i], gaussian[i]);
                        gaussian[i] *= ratio[i];
                        ratio[i] *= growth[i];
                    }
                }
                for i in 0..4 {
                    active[i] &=
                        u[i].simd_le(reach[i / 2].limit()) & lines[i].turn.simd_ge(reach[i / 2].least_turn);
                    if edges {
                        active[i] &= holds(self.source.full(), lines[i].x, lines[i].y);
                    }
                    let weight = active[i].select(weights[i], zero);
                    norm[i / 2] += weight;
                    places[i] = Place::new(field.frame, lines[i].x, lines[i].y);
                    let below = weight * places[i].below;
                    places[i].at.store_slice(&mut taps.at[i][k]);
                    (weight - below).store_slice(&mut taps.above[i][k]);
                    below.store_slice(&mut taps.below[i][k]);
                    places[i].right.store_slice(&mut taps.right[i][k]);
                }
                for i in 0..2 {
                    let either = active[2 * i] | active[2 * i + 1];
                    counts[i] = either.select(i32x8::splat(simd, k as i32 + 1), counts[i]);
                }
                for i in 0..4 {
                    active[i] &= (u[i] + reach[i / 2].step).simd_le(reach[i / 2].limit());
                }
                if !(active[0] | active[1] | active[2] | active[3]).any_true() {
                    break;
                }
            }
            for i in 0..2 {
                // As many for all: where the longest line ends is easier to predict than where each does.
                let count = counts[i].reduce_max() as usize;
                for lane in 0..BLOCK {
                    add(simd, taps, colors, [2 * i, lane], count, &mut totals[i * BLOCK + lane]);
                }
            }
        }
        let mut sums = [[0.0; 4 * BLOCK]; 2];
        for i in 0..2 * BLOCK {
            let ((all, _), (left, right)) = (totals[i][0].split(), totals[i][1].split());
            (all - left + right).store_slice(&mut sums[i / BLOCK][4 * (i % BLOCK)..][..4]);
        }
        (sums, norm)
    }

    /// Both sides of the lines through a block.
    #[inline(always)]
    fn begun<S: Simd>(&self, simd: S, x: i32, y: i32, last: i32) -> (Reach<S>, [Stream<S>; 2]) {
        let [e, f, g, _] = Block::until(last + 1, x, y).read(simd, &self.tensors);
        let [px, py] = Block::until(last + 1, x, y).centres(simd);
        (self.reach(e, f, g), Stream::both_sides(px, py, tangent(e, f, g)))
    }

    /// A band whose lines reach too far for copies of what is around tiles.
    #[inline(always)]
    fn fill_far<S: Simd>(&self, simd: S, covered: View<'_>, band: &mut Band<'_>) {
        let last = band.window.x1 - 1;
        for_blocks_in_tiles::<4>(band, |block, target| {
            write(self.far(simd, &covered, block.x, block.y, last), target)
        });
    }

    /// Up to eight pixels anywhere.
    #[inline(always)]
    fn far<S: Simd>(&self, simd: S, covered: &View<'_>, x: i32, y: i32, last: i32) -> [f32x8<S>; 4] {
        let (params, zero) = (&self.params, f32x8::splat(simd, 0.0));
        let field = StreamField {
            tensors: self.field,
            step: params.step,
            integrator: Integrator::of(params.integrator),
        };
        let (reach, mut lines) = self.begun(simd, x, y, last);
        let mut sum: [f32x8<S>; 4] = Block::until(last + 1, x, y).read(simd, covered);
        let mut norm = f32x8::splat(simd, 1.0);
        let mut u = [zero; 2];
        let mut active = [reach.step.simd_le(reach.limit()); 2];
        while (active[0] | active[1]).any_true() {
            field.advance_by(
                simd,
                &mut lines,
                [active[0].select(reach.step, zero), active[1].select(reach.step, zero)],
            );
            for side in 0..2 {
                let line = &lines[side];
                u[side] += self.arc(line, &reach);
                active[side] &= u[side].simd_le(reach.limit()) & field.inside(line);
                active[side] &= line.turn.simd_ge(reach.least_turn);
                let weight = active[side].select(reach.weight(u[side]), zero);
                let [r, g, b, a] = sample_linear4(simd, covered, line.x, line.y);
                sum = [
                    weight.mul_add(r, sum[0]),
                    weight.mul_add(g, sum[1]),
                    weight.mul_add(b, sum[2]),
                    weight.mul_add(a, sum[3]),
                ];
                norm += weight;
                active[side] &= (u[side] + reach.step).simd_le(reach.limit());
            }
        }
        mean(sum, norm)
    }
}

/// Adds up `count` steps to both sides of one pixel: the sums of left and right pixels, and the same times
/// the shares of the right ones. The left ones' shares are what is missing to one.
#[inline(always)]
fn add<S: Simd>(
    simd: S,
    taps: &Taps,
    colors: &Surroundings<FOUR>,
    [first, lane]: [usize; 2],
    count: usize,
    sums: &mut [f32x8<S>; 2],
) {
    let mut sides = [*sums, [f32x8::splat(simd, 0.0); 2]];
    for k in 0..count.min(RUN) {
        for (side, [all, right]) in sides.iter_mut().enumerate() {
            let line = first + side;
            let [above, below] = colors.both_rows(simd, taps.at[line][k][lane] as u16);
            let above = above * taps.above[line][k][lane];
            let pair = below.mul_add(f32x8::splat(simd, taps.below[line][k][lane]), above);
            *all += pair;
            *right = pair.mul_add(f32x8::splat(simd, taps.right[line][k][lane]), *right);
        }
    }
    *sums = [sides[0][0] + sides[1][0], sides[0][1] + sides[1][1]];
}

/// The colour and coverage of weighted sums of covered colours and of coverage.
#[inline(always)]
fn mean<S: Simd>([r, g, b, alpha]: [f32x8<S>; 4], norm: f32x8<S>) -> [f32x8<S>; 4] {
    let zero = f32x8::splat(norm.simd, 0.0);
    let seen = alpha.simd_gt(f32x8::splat(norm.simd, 1e-6));
    [
        seen.select(r / alpha, zero),
        seen.select(g / alpha, zero),
        seen.select(b / alpha, zero),
        full_or(alpha / norm),
    ]
}
