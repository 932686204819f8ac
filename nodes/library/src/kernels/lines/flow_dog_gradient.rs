//! First pass of the separable flow-based difference of Gaussians (§ 4.5, Listing 4.1): a
//! one-dimensional difference of Gaussians across the tangent, on lightness and coverage.
//!
//! Steps have length 1 along the axis nearer to the gradient, so a sample lies between two pixels of
//! one row or column, and two reads interpolate it exactly as a bilinear sample would.
//! Cost: per step (about 3 k sigma_e of them) four reads of two values; four exponentials per pixel.

pub use crate::kernels::shaders::flow_dog_gradient::Params;
use crate::kernels::shared::edge_threshold::{Xdog, dog_of_sums};
use crate::kernels::shared::tensor::tangent;
use crate::kernels::simd::line_taps::{LineTaps, strips};
use crate::kernels::simd::pixels::{BLOCK, Block, write};
use isophote_engine::fearless_simd::{Simd, f32x8, i32x8, mask32x8, prelude::*};
use isophote_engine::math::Elementary;
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance, View};

crate::kernel!(flow_dog_gradient {
    cpu: |simd, pass, params, band| gradient(simd, pass, &params, band),
    cost: |p| f64::from(p.halfwidth) * 0.88 * 50.0 + 40.0,
    tolerance: Tolerance {
        absolute: 1e-2,
        relative: 1e-4,
        outliers: 1e-2,
        reason: "a difference of Gaussians alone is what is left of highlights of thousands of L; the slope of a tangent is exact to a few units in the last place and shifts samples by \
                 as much times the local contrast, which is large beside a difference of Gaussians of \
                 highlights; a diagonal may take the other axis, and the last step may fall on either \
                 side of the cut-off",
    },
});

/// Cut-off, in standard deviations of the wider Gaussian; `precision` of Listing 4.1.
const PRECISION: f32 = 3.0;

/// Options of a difference of Gaussians.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Standard deviation of the narrower Gaussian, pixels.
    pub sigma: f32,
    /// Ratio of the two standard deviations.
    pub k: f32,
    /// Weights.
    pub xdog: Xdog,
    /// The fourth channel of the field is a factor on `sigma`, [`MOST`] at the most.
    pub scaled: bool,
}

/// Largest factor of a [control map](super::super::structure::control_field).
pub const MOST: f32 = 4.0;

/// Response across the orientations of `field` (E - G, F), or (E - G, F, 0, factor), of (L alpha, alpha), as (u alpha,
/// alpha), for standard deviations `sigma` and `k` `sigma` pixels.
pub fn pass(plan: &mut PlanBuilder, lightness: ImageId, field: ImageId, options: &Options) -> ImageId {
    let Options { sigma, k, xdog, scaled } = *options;
    let halfwidth = halfwidth(sigma, k);
    let falloff = |sigma: f32| -0.5 / (sigma * sigma).max(1e-6);
    let params = Params {
        narrow: falloff(sigma),
        wide: falloff(k * sigma),
        halfwidth,
        base: xdog.base,
        edge: xdog.edge,
        scaled: scaled.into(),
    };
    // A step is at least one pixel long, and a sample reaches one pixel further across.
    let support = Support::Pixels(reach(&params) as u32 + 1);
    plan.pass(&KERNEL, &[lightness, field], &params, Class::Colour, support)
}

/// The most pixels that a step lies away.
fn reach(params: &Params) -> i32 {
    (params.halfwidth * if params.scaled != 0 { MOST } else { 1.0 }).min(MOST_REACH) as i32
}

/// Reach of the first pass, in pixels.
pub fn halfwidth(sigma: f32, k: f32) -> f32 {
    (PRECISION * k * sigma).min(MOST_REACH)
}

/// Longest reach, pixels.
const MOST_REACH: f32 = 1024.0;

/// The line across the tangent through eight pixels.
#[derive(Clone, Copy)]
pub struct Across<S: Simd> {
    /// Absolute columns and rows of the pixels.
    pub at: [i32x8<S>; 2],
    /// Lanes that step along y.
    upright: mask32x8<S>,
    /// Pixels across per step.
    slope: f32x8<S>,
    /// Length of a step, 1..=sqrt 2.
    pub step: f32x8<S>,
}

impl<S: Simd> Across<S> {
    /// The lines across the tangents of the orientations (E - G, F) at the pixels of `block`.
    #[inline(always)]
    pub fn new(simd: S, block: &Block, [difference, f]: [f32x8<S>; 2]) -> Self {
        let [tx, ty] = tangent(difference, f, f32x8::splat(simd, 0.0));
        let upright = tx.abs().simd_gt(ty.abs());
        let slope = upright.select(-ty / tx, -tx / ty);
        Self {
            at: [block.columns(simd), i32x8::splat(simd, block.y)],
            upright,
            slope,
            step: (slope * slope + 1.0).sqrt(),
        }
    }

    /// The pixels nearest to step `k`. Ties are decided off the middle, so that rounding does not.
    #[inline(always)]
    pub fn nearest(&self, k: i32) -> [i32x8<S>; 2] {
        let i: i32x8<S> = (self.slope * k as f32 + 0.502).floor().to_int();
        let k = i32x8::splat(self.slope.simd, k);
        [self.at[0] + self.upright.select(i, k), self.at[1] + self.upright.select(k, i)]
    }

    /// Steps to the cut-off: the last `k` for which `k` times the length of a step does not exceed it.
    #[inline(always)]
    fn steps(&self, halfwidth: f32x8<S>) -> f32x8<S> {
        let one = f32x8::splat(self.step.simd, 1.0);
        // The quotient is rounded.
        let steps = (halfwidth / self.step).floor() + one;
        let steps = (steps * self.step).simd_le(halfwidth).select(steps, steps - one);
        (steps * self.step).simd_le(halfwidth).select(steps, steps - one)
    }
}

/// The Gaussian at the steps of a line, one after another: exp(a k^2) grows by exp(a (2 k + 1)) from step
/// k, and that by exp(2 a).
#[derive(Clone, Copy)]
struct Falloff<S: Simd> {
    exponent: f32x8<S>,
    value: f32x8<S>,
    ratio: f32x8<S>,
    growth: f32x8<S>,
}

impl<S: Simd> Falloff<S> {
    /// For steps of length `step` and the Gaussian exp(`exponent` d^2).
    #[inline(always)]
    fn new(step: f32x8<S>, exponent: f32x8<S>) -> Self {
        let exponent = step * step * exponent;
        let ratio = exponent.exp();
        Self { exponent, value: f32x8::splat(step.simd, 1.0), ratio, growth: ratio * ratio }
    }

    /// The value at step `k`, the one after the last asked for; the first is 1.
    #[inline(always)]
    fn at(&mut self, k: i32) -> f32x8<S> {
        if k % 16 == 0 {
            // Roundings grow with the square of the steps.
            self.value = (self.exponent * (k * k) as f32).exp();
            self.ratio = (self.exponent * (2 * k + 1) as f32).exp();
            return self.value;
        }
        self.value *= self.ratio;
        self.ratio *= self.growth;
        self.value
    }
}

#[inline(always)]
fn gradient<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, band: &mut Band<'_>) {
    let (radius, left) = (reach(params), band.window.x0);
    let mut lightness = LineTaps::default();
    for strip in strips(band, radius) {
        lightness.load2(simd, &pass.inputs[0], strip, radius);
        for y in strip.y0..strip.y1 {
            let target = &mut band.row_mut(0, y)[2 * (strip.x0 - left) as usize..];
            let mut x = strip.x0;
            while x < strip.x1 {
                let block = Block { x, y, len: BLOCK.min((strip.x1 - x) as usize) };
                let (orientation, factor) = directed(simd, &block, &pass.inputs[1], params.scaled != 0);
                let line = Across::new(simd, &block, orientation);
                let response = if lightness.is_opaque() {
                    differences::<S, true>(&lightness, params, &block, &line, factor)
                } else {
                    differences::<S, false>(&lightness, params, &block, &line, factor)
                };
                let at = 2 * (x - strip.x0) as usize;
                write(response, &mut target[at..at + 2 * block.len]);
                x += BLOCK as i32;
            }
        }
    }
}

/// The orientations (E - G, F) of a block, and the factor on standard deviations, which is 1 where the field has none.
#[inline(always)]
pub fn directed<S: Simd>(
    simd: S,
    block: &Block,
    field: &View<'_>,
    scaled: bool,
) -> ([f32x8<S>; 2], f32x8<S>) {
    if !scaled {
        return (block.read(simd, field), f32x8::splat(simd, 1.0));
    }
    let [difference, f, _, factor] = block.read(simd, field);
    ([difference, f], factor)
}

/// The responses of a block, and its coverage, which is 1 everywhere when `OPAQUE`.
#[inline(always)]
fn differences<S: Simd, const OPAQUE: bool>(
    lightness: &LineTaps,
    params: &Params,
    block: &Block,
    line: &Across<S>,
    factor: f32x8<S>,
) -> [f32x8<S>; 2] {
    let simd = factor.simd;
    let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
    let at = [block.x, block.y];
    let [middle, alpha] = lightness.centres(simd, at);
    let (mut narrow, mut narrow_alpha, mut wide, mut wide_alpha) = (middle, alpha, middle, alpha);
    let steps = line.steps((factor * params.halfwidth).at_most(MOST_REACH));
    let squared = factor * factor;
    let rates = [params.narrow, params.wide].map(|rate| f32x8::splat(simd, rate) / squared);
    // Lines along the other axis have no samples in a turn.
    for is_x in [true, false] {
        let along = if is_x { !line.upright } else { line.upright };
        if !along.any_true() {
            continue;
        }
        let mut falloff = [Falloff::new(line.step, rates[0]), Falloff::new(line.step, rates[1])];
        let mut k = 0;
        lightness.lines(at, is_x, along, line.slope, steps).for_steps(
            #[inline(always)]
            |step| {
                k += 1;
                let (v, a) = if OPAQUE {
                    let [[ahead], [behind]] = lightness.taps::<S, 1>(&step);
                    (ahead + behind, one + one)
                } else {
                    let [ahead, behind] = lightness.taps::<S, 2>(&step);
                    (ahead[0] + behind[0], ahead[1] + behind[1])
                };
                let n = step.active.select(falloff[0].at(k), zero);
                let w = step.active.select(falloff[1].at(k), zero);
                narrow = v.mul_add(n, narrow);
                narrow_alpha = a.mul_add(n, narrow_alpha);
                wide = v.mul_add(w, wide);
                wide_alpha = a.mul_add(w, wide_alpha);
            },
        );
    }
    let (u, covered) = dog_of_sums([narrow, narrow_alpha], [wide, wide_alpha], params.base, params.edge);
    [covered.select(u, zero) * alpha, alpha]
}
