//! Line integral convolution of a colour with a Gaussian along the stream lines of a tensor field
//! (2.186, 2.187), with the length adapted to the anisotropy (§ 6.3.1) or to the curvature (§ 6.3.2).
//!
//! Cost: 4 sigma / h steps per pixel, two fifths of it where steps are stretched, each one bilinear colour sample
//! and one (Euler, two-step) or two tensor samples with their tangents, about 90 or 130 operations.

use crate::declare::choice::Numbered;
pub use crate::kernels::shaders::line_integral_convolution::Params;
use crate::kernels::shared::coverage::{full_or, premultiply, unpremultiply};
use crate::kernels::shared::sampling::sample_linear4;
use crate::kernels::shared::stream::{
    FEW_STEPS, FieldView, Integrator, Stream, acos, few_steps, half_length, stretched,
};
use crate::kernels::shared::tensor::{anisotropy, tangent};
use crate::kernels::simd::pixels::{Block, read_tensors};
use crate::kernels::structure::orientation_field;
use crate::kernels::trace::tile_copy::{FOUR, TileCopy};
use crate::kernels::trace::{AlongLines, FieldCopy, Inputs, Lines, along_lines, both_sides};
use colour_taps::{ColourTaps, RUN, Sums};
use isophote_engine::fearless_simd::prelude::*;
use isophote_engine::fearless_simd::{Simd, f32x8, i32x8, mask32x8};
use isophote_engine::math::Elementary;
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance, View};

#[path = "line_integral_convolution/colour_taps.rs"]
mod colour_taps;

crate::kernel!(line_integral_convolution {
    cpu: run,
    cost: |p| {
        let steps = 2.0 * f64::from(half_length(p.sigma)) / f64::from(p.step * p.stretch);
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

crate::declare::choice::choice! {
    /// Adaptation of the length of the lines.
    pub enum Adapt {
        /// Not at all.
        None = 0 ("none", "Off"),
        /// Shorter where the direction is uncertain.
        Anisotropy = 1 ("anisotropy", "Where uncertain"),
        /// Shorter where the line turns.
        Angle = 2 ("angle", "Where they turn"),
    }
}

/// Options of a convolution.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Standard deviation along the line, pixels.
    pub sigma: f32,
    /// Step size h, pixels.
    pub step: f32,
    /// Most by which steps may be stretched ([`few_steps`]), at least 1.
    pub stretch: f32,
    /// Integrator by which the lines are stepped.
    pub integrator: Integrator,
    /// Takes the tensors of the nearest pixels instead of interpolating (§ 2.9.2).
    pub nearest: bool,
    /// Adaption of the length.
    pub adapt: Adapt,
    /// A side ends at a step that turns by more, degrees; 0 for never.
    pub max_angle: f32,
}

/// Smooths a colour along the stream lines of `tensors`; pixels count by their coverage.
pub fn pass(plan: &mut PlanBuilder, color: ImageId, tensors: ImageId, options: &Options) -> ImageId {
    let field = orientation_field::pass(plan, tensors);
    convolved(plan, [color, tensors, field], options)
}

/// The same where lengths are never adapted: the orientation field is all that is read of the tensors.
pub fn pass_unadapted(
    plan: &mut PlanBuilder,
    color: ImageId,
    tensors: ImageId,
    options: &Options,
) -> ImageId {
    let field = orientation_field::pass(plan, tensors);
    convolved(plan, [color, field, field], &Options { adapt: Adapt::None, ..*options })
}

fn convolved(plan: &mut PlanBuilder, inputs: [ImageId; 3], options: &Options) -> ImageId {
    let params = Params {
        sigma: options.sigma,
        step: options.step.max(MIN_STEP),
        // What has few steps at most need not work out how many they are.
        stretch: if half_length(options.sigma) > FEW_STEPS * options.step { options.stretch } else { 1.0 },
        least_turn: least_turn(options.max_angle),
        integrator: options.integrator as u32,
        adapt: options.adapt as u32,
        nearest: options.nearest.into(),
    };
    plan.pass(&KERNEL, &inputs, &params, Class::Colour, Support::Pixels(reach(&params) as u32))
}

/// Cosine of the greatest turn that a line survives, `max_angle` degrees; 0 for any.
pub(crate) fn least_turn(max_angle: f32) -> f32 {
    if max_angle > 0.0 { max_angle.to_radians().cos() } else { -1.0 }
}

/// Shorter steps cost much and gain nothing over rounding.
const MIN_STEP: f32 = 0.1;

/// The most pixels that are read to any side.
///
/// Adaptation only shortens lines; a bilinear sample at distance L reads one pixel further.
fn reach(params: &Params) -> i32 {
    half_length(params.sigma) as i32 + 1
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    let inputs = Inputs {
        source: pass.inputs[0],
        field: pass.inputs[2],
        integrator: Integrator::of(params.integrator),
        nearest: params.nearest != 0,
        reach: reach(&params),
    };
    let mut convolve =
        Convolve { params, colour: pass.inputs[0], tensors: pass.inputs[1], taps: Box::default() };
    along_lines(pass.level, &inputs, &mut convolve, band);
}

/// A weighted mean of colours along the lines.
struct Convolve<'a> {
    params: Params,
    colour: View<'a>,
    tensors: View<'a>,
    taps: Box<ColourTaps>,
}

impl AlongLines<FOUR, 4> for Convolve<'_> {
    #[inline(always)]
    fn near<S: Simd>(
        &mut self,
        simd: S,
        field: &FieldCopy<'_>,
        integrator: Integrator,
        colours: &TileCopy<FOUR>,
        blocks: &[Block; 2],
    ) -> [[f32x8<S>; 4]; 2] {
        let (near, [a, b]) = self.begin(simd, &blocks[0]);
        let (far, [c, d]) = self.begin(simd, &blocks[1]);
        let steps = [near.length, near.length, far.length, far.length];
        let mut arcs = [near, far];
        let (first, second) = (near.first(), far.first());
        let mut lines =
            Lines::new(simd, field, integrator, [a, b, c, d]).only([first, first, second, second]);
        let mut norm = [f32x8::splat(simd, 1.0); 2];
        let mut sums = Sums::zero(simd);
        let (carried, mut begins) = (!near.turns_count, true);
        while lines.go_on() {
            let mut counts = [i32x8::splat(simd, 0); 2];
            if !begins && carried {
                arcs[0].renew();
                arcs[1].renew();
            }
            begins = false;
            lines.trace(
                simd,
                field,
                steps,
                RUN,
                #[inline(always)]
                |k, i, point| {
                    let (block, side) = (i / 2, i % 2);
                    let weight = if carried {
                        arcs[block].equal_step(side)
                    } else {
                        arcs[block].step(side, &point.line)
                    };
                    let active = point.active & arcs[block].holds(side, &point.line);
                    let weight = active.select(weight, f32x8::splat(simd, 0.0));
                    norm[block] += weight;
                    self.taps.put(k, i, weight, &point.place);
                    counts[block] = active.select(i32x8::splat(simd, k as i32 + 1), counts[block]);
                    active & arcs[block].goes_on(side)
                },
            );
            self.taps.add_up(simd, colours, counts, &mut sums);
        }
        let [first, second] = sums.channels(simd);
        [
            mean(self.with_centre(simd, &blocks[0], first), norm[0]),
            mean(self.with_centre(simd, &blocks[1], second), norm[1]),
        ]
    }

    #[inline(always)]
    fn far<S: Simd>(
        &mut self,
        simd: S,
        field: &FieldView<'_>,
        integrator: Integrator,
        covered: &View<'_>,
        block: &Block,
    ) -> [f32x8<S>; 4] {
        let (mut arcs, sides) = self.begin(simd, block);
        let mut lines = Lines::new(simd, field, integrator, sides).only([arcs.first(); 2]);
        let mut sum = block.read(simd, covered);
        let mut norm = f32x8::splat(simd, 1.0);
        lines.trace(
            simd,
            field,
            [arcs.length; 2],
            usize::MAX,
            #[inline(always)]
            |_, side, point| {
                let weight = arcs.step(side, &point.line);
                let active = point.active & arcs.holds(side, &point.line);
                let weight = active.select(weight, f32x8::splat(simd, 0.0));
                let tap = sample_linear4(simd, covered, point.line.x, point.line.y);
                for c in 0..4 {
                    sum[c] = weight.mul_add(tap[c], sum[c]);
                }
                norm += weight;
                active & arcs.goes_on(side)
            },
        );
        mean(sum, norm)
    }
}

impl Convolve<'_> {
    /// The lines through a block.
    #[inline(always)]
    fn begin<S: Simd>(&self, simd: S, block: &Block) -> (Arcs<S>, [Stream<S>; 2]) {
        let channels = self.tensors.channels();
        let at = self.tensors.offset(block.x, block.y);
        let [e, f, g] = read_tensors(simd, &self.tensors.data()[at..at + channels * block.len], channels);
        (Arcs::new(&self.params, e, f, g), both_sides(simd, block, tangent(e, f, g)))
    }

    /// Sums of weighted colours with those of the centres, whose weight is 1.
    #[inline(always)]
    fn with_centre<S: Simd>(&self, simd: S, block: &Block, mut sum: [f32x8<S>; 4]) -> [f32x8<S>; 4] {
        let centre = premultiply(block.read(simd, &self.colour));
        for c in 0..4 {
            sum[c] += centre[c];
        }
        sum
    }
}

/// The arc lengths along both sides of eight lines, and the weights that fall off with them.
#[derive(Clone, Copy)]
struct Arcs<S: Simd> {
    radius: f32x8<S>,
    falloff: f32x8<S>,
    /// Of a step.
    length: f32x8<S>,
    /// Cosine of the most that lines may turn in one of them.
    least_turn: f32x8<S>,
    /// True where the arc length runs faster where lines turn.
    turns_count: bool,
    /// Arc length that each side has come.
    u: [f32x8<S>; 2],
    /// Over equal steps the Gaussian is carried from one to the next: the weight of the next step, by how much
    /// that of the one after is less, and by how much that changes.
    gaussian: f32x8<S>,
    ratio: f32x8<S>,
    growth: f32x8<S>,
}

impl<S: Simd> Arcs<S> {
    /// Of lines through pixels with the tensors (e, f, g).
    #[inline(always)]
    fn new(params: &Params, e: f32x8<S>, f: f32x8<S>, g: f32x8<S>) -> Self {
        let mut sigma = f32x8::splat(e.simd, params.sigma);
        if params.adapt == Adapt::Anisotropy as u32 {
            let a = anisotropy(e, f, g) + 1.0;
            sigma *= a * a * 0.25;
        }
        let radius = (sigma * 2.0 + 1e-3).floor();
        let falloff =
            f32x8::splat(e.simd, -0.721_347_52) / (sigma * sigma).at_least(f32x8::splat(e.simd, 1e-6));
        let (length, least_turn) = stretched_step(params, radius);
        let gaussian = (falloff * length * length).exp2_falling();
        let growth = gaussian * gaussian;
        Self {
            radius,
            falloff,
            length,
            least_turn,
            turns_count: params.adapt == Adapt::Angle as u32,
            u: [f32x8::splat(e.simd, 0.0); 2],
            gaussian,
            ratio: growth * gaussian,
            growth,
        }
    }

    /// The arc length that the last step does not exceed.
    #[inline(always)]
    fn limit(&self) -> f32x8<S> {
        self.radius + 1e-3
    }

    /// Lanes whose lines have a first step.
    #[inline(always)]
    fn first(&self) -> mask32x8<S> {
        self.length.simd_le(self.limit())
    }

    /// The weights at arc length `u`.
    #[inline(always)]
    fn weight(&self, u: f32x8<S>) -> f32x8<S> {
        (self.falloff * u * u).exp2_falling()
    }

    /// Finds the carried weights anew: roundings would grow by the square of the number of steps.
    #[inline(always)]
    fn renew(&mut self) {
        let next = self.u[0] + self.length;
        self.gaussian = self.weight(next);
        self.ratio = (self.falloff * self.length * (next + next + self.length)).exp2_falling();
    }

    /// The weights after a step of a side, where turns do not count: carried from the last step. The first side
    /// comes first.
    #[inline(always)]
    fn equal_step(&mut self, side: usize) -> f32x8<S> {
        let weight = self.gaussian;
        if side == 0 {
            self.u[0] += self.length;
        } else {
            self.u[1] = self.u[0];
            self.gaussian *= self.ratio;
            self.ratio *= self.growth;
        }
        weight
    }

    /// The weights after any step of a side.
    #[inline(always)]
    fn step(&mut self, side: usize, line: &Stream<S>) -> f32x8<S> {
        self.u[side] += if self.turns_count {
            self.length.at_least(acos(line.turn) * self.radius / std::f32::consts::PI)
        } else {
            self.length
        };
        self.weight(self.u[side])
    }

    /// Lanes that have come neither too far nor round too sharp a turn.
    #[inline(always)]
    fn holds(&self, side: usize, line: &Stream<S>) -> mask32x8<S> {
        self.u[side].simd_le(self.limit()) & line.turn.simd_ge(self.least_turn)
    }

    /// Lanes that have a next step.
    #[inline(always)]
    fn goes_on(&self, side: usize) -> mask32x8<S> {
        (self.u[side] + self.length).simd_le(self.limit())
    }
}

/// The length of a step of lines of `radius` pixels a side, and the cosine of the most that they may turn in
/// one of them.
#[inline(always)]
fn stretched_step<S: Simd>(params: &Params, radius: f32x8<S>) -> (f32x8<S>, f32x8<S>) {
    let one = f32x8::splat(radius.simd, 1.0);
    if params.stretch <= 1.0 {
        return (one * params.step, one * params.least_turn);
    }
    let steps = ((radius + 1e-3) * params.step.recip()).floor();
    let stretch = stretched(steps, few_steps(steps, params.stretch));
    // The cosine of so many times the angle whose cosine is c, exact for one and two times; no more than c,
    // since -1 stands for any turn.
    let c = one * params.least_turn;
    let least_turn = c.at_most(one - stretch * ((one - c) * (one - c) + stretch * c * (one - c)));
    (stretch * params.step, least_turn)
}

/// The colour and coverage of weighted sums of covered colours and of coverage.
#[inline(always)]
fn mean<S: Simd>(sum: [f32x8<S>; 4], norm: f32x8<S>) -> [f32x8<S>; 4] {
    let [r, g, b, alpha] = unpremultiply(sum);
    [r, g, b, full_or(alpha / norm)]
}
