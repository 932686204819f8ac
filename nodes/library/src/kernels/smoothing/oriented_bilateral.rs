//! One pass of the orientation-aligned bilateral filter (§ 3.4, Listing 3.1), along the gradient or
//! along the tangent; the first pass of the flow-based bilateral filter (§ 3.5) is the same.
//!
//! Taps are one pixel apart along the axis that is nearer to the direction, so each lies between two
//! pixels (3.6, 3.7). The range is measured as Euclidean distance of the three colour channels, taps
//! count by their coverage, and coverage itself passes: the edge of a cut-out is an edge to preserve.
//!
//! Nearest sampling takes the nearer of the two, and both where they are equally near.
//!
//! Cost: about 1.8 cutoff taps of one interpolation and one exponential (manual: two or more).

pub use crate::kernels::shaders::oriented_bilateral::Params;
use crate::kernels::shared::coverage::premultiply;
use crate::kernels::shared::tensor::{anisotropy, tangent};
use crate::kernels::simd::line_taps::{LineTaps, Lines, STEPS, strips};
use crate::kernels::simd::pixels::{read, read_tensors, write};
use isophote_engine::apart;
use isophote_engine::fearless_simd::prelude::*;
use isophote_engine::fearless_simd::{Simd, f32x8};
use isophote_engine::math::Elementary;
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Rect, Support, Tolerance, View};

crate::kernel!(oriented_bilateral {
    cpu: |simd, pass, params, band| filter(simd, pass, &params, band),
    cost: |p| 1.8 * f64::from(p.cutoff) * if p.sampling == Sampling::Linear as u32 { 35.0 } else { 50.0 },
    tolerance: Tolerance {
        absolute: 2e-3,
        relative: 2e-4,
        outliers: 0.002,
        reason: "where the tensor is nearly isotropic its direction turns by many roundings, and the \
                 last bit decides whether a line has one more tap",
    },
});

/// Direction of a pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// Across the edges: the major eigenvector.
    Gradient = 0,
    /// Along the edges: the minor eigenvector.
    Tangent = 1,
}

crate::declare::choice::choice! {
    /// Where range weights are applied.
    pub enum Sampling {
        /// Colours are blended, then compared.
        Linear = 0 ("linear", "Smooth"),
        /// Both pixels are compared, then blended.
        Manual = 1 ("manual", "Sharp"),
        /// The nearest pixel is compared, and nothing blended.
        Nearest = 2 ("nearest", "Jagged"),
    }
}

/// Options of a pass.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Standard deviation along the line, pixels.
    pub sigma_d: f32,
    /// Standard deviation of the range, in the unit of the colour.
    pub sigma_r: f32,
    /// Places where range weights are applied.
    pub sampling: Sampling,
    /// Elongation per unit of anisotropy; 0 for none.
    pub elongation: f32,
    /// The fourth channel of the tensors is a factor on `sigma_r`.
    pub scaled: bool,
}

/// Lines are cut at ceil(3 sigma_d) pixels (§ 3.4).
const PRECISION: f32 = 3.0;

/// Filters a colour, usually CIELAB, along one direction of the tensors; their orientation field does where nothing is
/// elongated.
pub fn pass(
    plan: &mut PlanBuilder,
    color: ImageId,
    tensors: ImageId,
    direction: Direction,
    options: &Options,
) -> ImageId {
    let params = Params {
        sigma_d: options.sigma_d,
        sigma_r: options.sigma_r,
        cutoff: (PRECISION * options.sigma_d).ceil(),
        elongation: options.elongation,
        tangential: direction as u32,
        sampling: options.sampling as u32,
        scaled: options.scaled.into(),
    };
    plan.pass(&KERNEL, &[color, tensors], &params, Class::Colour, Support::Pixels(reach(&params) as u32))
}

/// The most pixels that a tap lies away along either axis.
///
/// At 45 degrees a tap at distance d reads floor(d / sqrt 2) + 1 pixels away along the minor axis,
/// which is never more than ceil(d) for the distances that can occur there.
fn reach(params: &Params) -> i32 {
    let stretch = if params.tangential != 0 { 1.0 + params.elongation } else { 1.0 };
    (params.cutoff * stretch).ceil() as i32
}

#[inline(always)]
fn filter<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, band: &mut Band<'_>) {
    let (radius, left) = (reach(params), band.window.x0);
    let mut colours = LineTaps::default();
    let zero = f32x8::splat(simd, 0.0);
    let mut block = Block { taps: [[[zero; 4]; 2]; STEPS], coverage: [[zero; 2]; STEPS] };
    for strip in strips(band, radius) {
        colours.load(simd, &pass.inputs[0], strip, radius, params.sampling == Sampling::Linear as u32);
        let mode = match (params.sampling != Sampling::Linear as u32, colours.is_opaque()) {
            (true, _) => MANUAL,
            (false, true) => OPAQUE,
            (false, false) => COVERED,
        };
        let values = |view: &View<'_>, y: i32| {
            view.offset(strip.x0, y)..view.offset(strip.x1 - 1, y) + view.channels()
        };
        let (colour, tensors) = (&pass.inputs[0], &pass.inputs[1]);
        for y in strip.y0..strip.y1 {
            let row = Row {
                params,
                colours: &colours,
                origins: &colour.data()[values(colour, y)],
                tensors: &tensors.data()[values(tensors, y)],
                channels: tensors.channels(),
                strip,
                y,
            };
            let target = &mut band.row_mut(0, y)[4 * (strip.x0 - left) as usize..];
            let (mut i, count) = (0, strip.width() as usize);
            while i < count {
                let result = match mode {
                    MANUAL => apart!(simd, row.filtered::<S, MANUAL>(simd, i, &mut block)),
                    OPAQUE => apart!(simd, row.filtered::<S, OPAQUE>(simd, i, &mut block)),
                    _ => apart!(simd, row.filtered::<S, COVERED>(simd, i, &mut block)),
                };
                write(result, &mut target[4 * i..4 * count.min(i + 8)]);
                i += 8;
            }
        }
    }
}

/// Linear sampling where all coverage is 1, and where it is not; sampling of both pixels.
const OPAQUE: u32 = 0;
const COVERED: u32 = 1;
const MANUAL: u32 = 2;

/// A row of a strip.
struct Row<'a> {
    params: &'a Params,
    colours: &'a LineTaps,
    origins: &'a [f32],
    tensors: &'a [f32],
    /// Of the tensors.
    channels: usize,
    strip: Rect,
    y: i32,
}

/// Weights of eight lines: origins, exponents of the range weight per squared distance and of the domain
/// weight per squared step.
#[derive(Clone, Copy)]
struct Weights<S: Simd> {
    origin: [f32x8<S>; 4],
    range: f32x8<S>,
    domain: f32x8<S>,
}

/// Of some steps, the colours ahead and behind with the exponents of their weights, and their coverage.
struct Block<S: Simd> {
    taps: [[[f32x8<S>; 4]; 2]; STEPS],
    coverage: [[f32x8<S>; 2]; STEPS],
}

impl<S: Simd> Block<S> {
    /// Adds the colours of `count` steps to the sums of colours and weights.
    #[inline(always)]
    fn add<const MODE: u32>(&self, count: usize, sum: &mut [f32x8<S>; 4]) {
        for i in 0..count.min(STEPS) {
            let taps = self.taps[i];
            let weights = exponential(taps[0][3], taps[1][3]);
            for side in 0..2 {
                let ([r, g, b, _], weight) = (taps[side], weights[side]);
                let share = if MODE == COVERED { weight * self.coverage[i][side] } else { weight };
                add(sum, weight, [r, g, b], share);
            }
        }
    }
}

impl Row<'_> {
    /// The eight pixels from pixel `i` of the row on; past its end they repeat the last one.
    #[inline(always)]
    fn filtered<S: Simd, const MODE: u32>(&self, simd: S, i: usize, block: &mut Block<S>) -> [f32x8<S>; 4] {
        let params = self.params;
        let at = [self.strip.x0 + i as i32, self.y];
        let [e, f, g] = read_tensors(simd, &self.tensors[self.channels * i..], self.channels);
        let [tx, ty] = tangent(e, f, g);
        let stretch = if params.elongation > 0.0 {
            anisotropy(e, f, g) * params.elongation + 1.0
        } else {
            f32x8::splat(simd, 1.0)
        };
        let tangential = params.tangential != 0;
        let [tx, ty] = if tangential { [tx, ty] } else { [ty, -tx] };
        let scale = if tangential { stretch } else { f32x8::splat(simd, 1.0) / stretch };

        let along_x = tx.abs().simd_gt(ty.abs());
        let major = along_x.select(tx, ty);
        let slope = along_x.select(ty, tx) / major;
        let steps = ((scale * params.cutoff + 1e-3) * major.abs()).floor();
        let sigma_d = scale * params.sigma_d * major.abs();
        let origin = if MODE == OPAQUE {
            let [r, g, b] = self.colours.centres(simd, at);
            [r, g, b, f32x8::splat(simd, 1.0)]
        } else {
            read(simd, &self.origins[4 * i..])
        };
        let weights = Weights {
            origin,
            range: self.range(simd, i),
            domain: f32x8::splat(simd, -0.721_347_52)
                / (sigma_d * sigma_d).at_least(f32x8::splat(simd, 1e-6)),
        };
        let alpha = origin[3];
        let mut sum = premultiply(origin);
        // Lines along the other axis have no taps in a turn.
        for is_x in [true, false] {
            let along = if is_x { along_x } else { !along_x };
            if along.any_true() {
                let lines = self.colours.lines(at, is_x, along, slope, steps);
                self.gather::<S, MODE>(&lines, &weights, block, &mut sum);
            }
        }
        let seen = sum[3].simd_gt(f32x8::splat(simd, 1e-6));
        let n = f32x8::splat(simd, 1.0) / sum[3];
        [
            seen.select(sum[0] * n, origin[0]),
            seen.select(sum[1] * n, origin[1]),
            seen.select(sum[2] * n, origin[2]),
            alpha,
        ]
    }

    /// Exponents of the range weight per squared distance, of eight pixels.
    #[inline(always)]
    fn range<S: Simd>(&self, simd: S, i: usize) -> f32x8<S> {
        const EXPONENT: f32 = -0.721_347_52;
        let sigma = self.params.sigma_r;
        if self.params.scaled == 0 {
            return f32x8::splat(simd, EXPONENT / (sigma * sigma).max(1e-6));
        }
        let [.., factor] = read::<S, 4>(simd, &self.tensors[4 * i..]);
        let sigma = factor * sigma;
        f32x8::splat(simd, EXPONENT) / (sigma * sigma).at_least(1e-6)
    }

    /// Adds the taps of `lines` to the sums of colours and weights.
    #[inline(always)]
    fn gather<S: Simd, const MODE: u32>(
        &self,
        lines: &Lines<S>,
        weights: &Weights<S>,
        block: &mut Block<S>,
        sum: &mut [f32x8<S>; 4],
    ) {
        let simd = weights.domain.simd;
        let (one, none) = (f32x8::splat(simd, 1.0), f32x8::splat(simd, -1e3));
        let nearest = self.params.sampling == Sampling::Nearest as u32;
        // Taps and exponents of some steps first, then their exponential functions: one after the other
        // these would be one long chain, and what each needs would not fit the registers.
        lines.for_blocks(
            &mut (block, sum),
            #[inline(always)]
            |(block, sum), i, step| {
                // Lines that have ended have black taps, which must weigh less than a float can add to the sum.
                let domain = step.active.select(weights.domain * step.distance * step.distance, none);
                if MODE == MANUAL {
                    self.colours.for_rows::<S, 4>(
                        &step,
                        #[inline(always)]
                        |share, [[r0, g0, b0, a0], [r1, g1, b1, a1]]| {
                            let [e0, e1] = weights.exponents([[r0, g0, b0], [r1, g1, b1]], domain);
                            let [w0, w1] = exponential(e0, e1);
                            let share = if nearest { round_half(share) } else { share };
                            let (w0, w1) = (w0 * share * a0, w1 * share * a1);
                            add(sum, w0, [r0, g0, b0], w0);
                            add(sum, w1, [r1, g1, b1], w1);
                        },
                    );
                } else if MODE == COVERED {
                    let [[r0, g0, b0, a0], [r1, g1, b1, a1]] = self.colours.taps::<S, 4>(&step);
                    let (n0, n1) = (one / a0.at_least(1e-6), one / a1.at_least(1e-6));
                    let [e0, e1] =
                        weights.exponents([[r0 * n0, g0 * n0, b0 * n0], [r1 * n1, g1 * n1, b1 * n1]], domain);
                    block.taps[i] = [[r0, g0, b0, e0], [r1, g1, b1, e1]];
                    block.coverage[i] = [a0, a1];
                } else {
                    let [[r0, g0, b0], [r1, g1, b1]] = self.colours.taps::<S, 3>(&step);
                    let [e0, e1] = weights.exponents([[r0, g0, b0], [r1, g1, b1]], domain);
                    block.taps[i] = [[r0, g0, b0, e0], [r1, g1, b1, e1]];
                }
            },
            #[inline(always)]
            |(block, sum), count| {
                if MODE != MANUAL {
                    block.add::<MODE>(count, sum);
                }
            },
        );
    }
}

impl<S: Simd> Weights<S> {
    /// The exponents of the weights of two colours; `domain` are those of their domain weights.
    #[inline(always)]
    fn exponents(&self, colours: [[f32x8<S>; 3]; 2], domain: f32x8<S>) -> [f32x8<S>; 2] {
        let mut exponents = [domain; 2];
        for i in 0..2 {
            let [r, g, b] = colours[i];
            let (r, g, b) = (r - self.origin[0], g - self.origin[1], b - self.origin[2]);
            let square = b.mul_add(b, g.mul_add(g, r * r));
            exponents[i] = square.mul_add(self.range, domain);
        }
        exponents
    }
}

/// 1 from a half on, else 0.
#[inline(always)]
fn round_half<S: Simd>(share: f32x8<S>) -> f32x8<S> {
    let simd = share.simd;
    share.simd_ge(0.5).select(f32x8::splat(simd, 1.0), f32x8::splat(simd, 0.0))
}

/// 2^x of two vectors.
#[inline(always)]
fn exponential<S: Simd>(a: f32x8<S>, b: f32x8<S>) -> [f32x8<S>; 2] {
    a.combine(b).exp2_falling().split().into()
}

/// Adds a weighted colour, and its share of the weights.
#[inline(always)]
fn add<S: Simd>(sum: &mut [f32x8<S>; 4], weight: f32x8<S>, colour: [f32x8<S>; 3], share: f32x8<S>) {
    for channel in 0..3 {
        sum[channel] = weight.mul_add(colour[channel], sum[channel]);
    }
    sum[3] += share;
}
