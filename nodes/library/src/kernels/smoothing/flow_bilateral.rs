//! Second pass of the flow-based bilateral filter (3.10): a bilateral filter along the stream lines of
//! a tensor field, sampled at equal distances or where lines cross the centres of rows or columns
//! (Listings 3.2, 3.3). The first pass is that of `oriented_bilateral`.
//!
//! At such a crossing a bilinear sample lies between two pixels only and blurs less. Taps count by their
//! coverage, and coverage itself passes. Manual sampling weights each pixel of the bilinear sample by
//! its own range; at a crossing that is (3.9).
//!
//! Cost: 4 sigma steps per pixel, each one bilinear colour sample with one exponential (manual: four)
//! and one (Euler) or two tensor samples with their tangents.

use crate::declare::choice::Numbered;
pub use crate::kernels::shaders::flow_bilateral::Params;
use crate::kernels::shared::coverage::{Covered, premultiply};
use crate::kernels::shared::sampling::{fetch4, sample_linear4};
use crate::kernels::shared::stream::{FieldView, Integrator, Stream, half_length, in_bounds};
use crate::kernels::shared::tensor::tangent;
use crate::kernels::simd::pixels::{Block, for_blocks_in_tiles, write};
use crate::kernels::smoothing::oriented_bilateral::Sampling;
use crate::kernels::structure::orientation_field;
use crate::kernels::trace::{Lines, Point, both_sides};
use isophote_engine::fearless_simd::prelude::*;
use isophote_engine::fearless_simd::{Simd, dispatch, f32x8, i32x8, mask32x8};
use isophote_engine::math::Elementary;
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance, View};

crate::kernel!(flow_bilateral {
    cpu: run,
    cost: |p| {
        let field = if p.integrator == Integrator::Euler as u32 { 50.0 } else { 100.0 };
        2.0 * f64::from(p.radius) * (field + if p.sampling == Sampling::Manual as u32 { 120.0 } else { 50.0 })
    },
    tolerance: Tolerance {
        absolute: 5e-3,
        relative: 1e-3,
        outliers: 0.02,
        reason: "stream lines add up roundings; where the field is undetermined, or a line leaves the \
                 picture, the last bit decides where it goes, and one such pixel is a large share of a \
                 small picture",
    },
});

crate::declare::choice::choice! {
    /// Where stream lines are sampled.
    pub enum Placement {
        /// At every pixel of length.
        Equidistant = 0 ("equidistant", "Even distances"),
        /// Where they cross the centre of a row or a column.
        PixelCentres = 1 ("pixel_centres", "Pixel centres"),
    }
}

/// Options of a pass.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Standard deviation along the line, pixels.
    pub sigma_d: f32,
    /// Standard deviation of the range, in the unit of the colour.
    pub sigma_r: f32,
    /// Integrator by which lines are stepped.
    pub integrator: Integrator,
    /// Places where range weights are applied.
    pub sampling: Sampling,
    /// Places where lines are sampled.
    pub placement: Placement,
}

/// Filters a colour, usually CIELAB, along the stream lines of `tensors`.
pub fn pass(plan: &mut PlanBuilder, color: ImageId, tensors: ImageId, options: &Options) -> ImageId {
    let params = Params {
        sigma_d: options.sigma_d,
        sigma_r: options.sigma_r,
        // Stream lines are cut early because they grow less accurate with length (§ 2.9.3).
        radius: half_length(options.sigma_d),
        integrator: options.integrator as u32,
        sampling: options.sampling as u32,
        placement: options.placement as u32,
    };
    // No sample lies further away than the line is long, and a bilinear one reads a pixel more.
    let support = Support::Pixels(reach(&params) as u32);
    let field = orientation_field::pass(plan, tensors);
    plan.pass(&KERNEL, &[color, field], &params, Class::Colour, support)
}

fn reach(params: &Params) -> i32 {
    params.radius as i32 + 1
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    let covered = (params.sampling == Sampling::Linear as u32)
        .then(|| Covered::new(&pass.inputs[0], band, reach(&params)));
    let filter = Filter {
        params,
        origins: pass.inputs[0],
        source: covered.as_ref().map_or(pass.inputs[0], |c| c.view(&pass.inputs[0])),
        field: FieldView::new(pass.inputs[1]),
        opaque: covered.as_ref().is_some_and(Covered::is_opaque),
    };
    dispatch!(pass.level, simd => for_blocks_in_tiles::<4>(band, #[inline(always)] |block, target| {
        write(filter.block(simd, &block), target);
    }));
}

/// Values that all blocks of a band share.
struct Filter<'a> {
    params: Params,
    origins: View<'a>,
    /// Colours times coverage for linear sampling, as they are for manual.
    source: View<'a>,
    field: FieldView<'a>,
    /// All coverage is 1.
    opaque: bool,
}

/// Values that all samples of eight lines share.
#[derive(Clone, Copy)]
struct Origin<S: Simd> {
    colour: [f32x8<S>; 4],
    /// Factor on the squared distance of colours.
    range: f32,
}

/// Places where eight lines are sampled.
struct Tap<S: Simd> {
    x: f32x8<S>,
    y: f32x8<S>,
    /// Pixels behind the point that the lines have come to.
    back: f32x8<S>,
    /// Lanes that are sampled.
    sampled: mask32x8<S>,
    /// Lanes whose line goes on: it ends with the first sample outside the picture.
    goes_on: mask32x8<S>,
}

impl Filter<'_> {
    #[inline(always)]
    fn block<S: Simd>(&self, simd: S, block: &Block) -> [f32x8<S>; 4] {
        let (params, zero) = (&self.params, f32x8::splat(simd, 0.0));
        let [difference, f] = block.read(simd, &self.field.tensors);
        let colour = block.read(simd, &self.origins);
        let range = -0.721_347_52 / (params.sigma_r * params.sigma_r).max(1e-6);
        let domain = f32x8::splat(simd, -0.721_347_52 / (params.sigma_d * params.sigma_d).max(1e-6));
        let origin = Origin { colour, range };
        let at_crossings = params.placement == Placement::PixelCentres as u32;
        let alpha = colour[3];
        let first = premultiply(colour);
        let mut sum = if at_crossings { [zero; 4] } else { first };
        let sides = both_sides(simd, block, tangent(difference, f, zero));
        let mut lines = Lines::new(simd, &self.field, Integrator::of(params.integrator), sides);
        // The sample before, and how far away it lies.
        let (mut before, mut before_u) = ([first; 2], [zero; 2]);
        lines.trace_beyond(
            simd,
            &self.field,
            [zero + 1.0; 2],
            params.radius as usize,
            #[inline(always)]
            |k, side, point| {
                let tap = self.tap(point, at_crossings);
                let u = f32x8::splat(simd, (k + 1) as f32) - tap.back;
                let value = self.weighted(simd, [tap.x, tap.y], &origin, domain * u * u);
                if at_crossings {
                    let width = tap.sampled.select((u - before_u[side]) * 0.5, zero);
                    for i in 0..4 {
                        sum[i] = width.mul_add(before[side][i] + value[i], sum[i]);
                        before[side][i] = tap.sampled.select(value[i], before[side][i]);
                    }
                    before_u[side] = tap.sampled.select(u, before_u[side]);
                } else {
                    for i in 0..4 {
                        sum[i] += tap.sampled.select(value[i], zero);
                    }
                }
                tap.goes_on
            },
        );
        let seen = sum[3].simd_gt(f32x8::splat(simd, 1e-6));
        [
            seen.select(sum[0] / sum[3], colour[0]),
            seen.select(sum[1] / sum[3], colour[1]),
            seen.select(sum[2] / sum[3], colour[2]),
            alpha,
        ]
    }

    /// Place where a step of eight lines is sampled: at its end, or at the last crossing it has made.
    #[inline(always)]
    fn tap<S: Simd>(&self, point: &Point<S, [f32x8<S>; 2]>, at_crossings: bool) -> Tap<S> {
        let (line, mut sampled) = (&point.line, point.active);
        let mut back = f32x8::splat(line.x.simd, 0.0);
        if at_crossings {
            let distance = distance_back(line);
            sampled &= distance.simd_lt(1.0);
            back = sampled.select(distance, back);
        }
        let x = line.x - back * line.direction[0];
        let y = line.y - back * line.direction[1];
        let inside = in_bounds(self.field.tensors.full(), x, y);
        let goes_on = point.active & (inside | !sampled);
        Tap { x, y, back, sampled: sampled & inside, goes_on }
    }

    /// Samples times their domain and range weights and their coverage.
    #[inline(always)]
    fn weighted<S: Simd>(
        &self,
        simd: S,
        [x, y]: [f32x8<S>; 2],
        origin: &Origin<S>,
        domain: f32x8<S>,
    ) -> [f32x8<S>; 4] {
        if self.params.sampling == Sampling::Linear as u32 {
            let [r, g, b, a] = sample_linear4(simd, &self.source, x, y);
            let mut colour = [r, g, b];
            if !self.opaque {
                let seen = f32x8::splat(simd, 1.0) / a.at_least(f32x8::splat(simd, 1e-6));
                colour = [r * seen, g * seen, b * seen];
            }
            let weight = weight(colour, origin, domain);
            return [r * weight, g * weight, b * weight, a * weight];
        }
        if self.params.sampling == Sampling::Nearest as u32 {
            let [r, g, b, a] = fetch4(simd, &self.source, x.floor().to_int(), y.floor().to_int());
            let weight = weight([r, g, b], origin, domain) * a;
            return [r * weight, g * weight, b * weight, weight];
        }
        let (x, y) = (x - 0.5, y - 0.5);
        let (left, top) = (x.floor(), y.floor());
        let (fx, fy) = (x - left, y - top);
        let (left, top): (i32x8<S>, i32x8<S>) = (left.to_int(), top.to_int());
        let mut sum = [f32x8::splat(simd, 0.0); 4];
        for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let share = if dx == 0 { f32x8::splat(simd, 1.0) - fx } else { fx };
            let share = share * if dy == 0 { f32x8::splat(simd, 1.0) - fy } else { fy };
            let [r, g, b, a] = fetch4(simd, &self.source, left + dx, top + dy);
            let weight = weight([r, g, b], origin, domain) * share * a;
            sum[0] = weight.mul_add(r, sum[0]);
            sum[1] = weight.mul_add(g, sum[1]);
            sum[2] = weight.mul_add(b, sum[2]);
            sum[3] += weight;
        }
        sum
    }
}

#[inline(always)]
fn weight<S: Simd>(colour: [f32x8<S>; 3], origin: &Origin<S>, domain: f32x8<S>) -> f32x8<S> {
    let d0 = colour[0] - origin.colour[0];
    let d1 = colour[1] - origin.colour[1];
    let d2 = colour[2] - origin.colour[2];
    (d2.mul_add(d2, d1.mul_add(d1, d0 * d0)) * origin.range + domain).exp2()
}

/// Distance back to where lines last crossed the centre of a row or column (3.11).
#[inline(always)]
fn distance_back<S: Simd>(line: &Stream<S>) -> f32x8<S> {
    let (x, near_x) = back_along(line.x, line.direction[0]);
    let (y, near_y) = back_along(line.y, line.direction[1]);
    (near_x | near_y).select(f32x8::splat(x.simd, 0.0), x.at_most(y))
}

/// The same along one axis, and whether a crossing lies within rounding of the position.
#[inline(always)]
fn back_along<S: Simd>(p: f32x8<S>, t: f32x8<S>) -> (f32x8<S>, mask32x8<S>) {
    let simd = p.simd;
    let p = p + 0.5;
    let f = p - p.floor();
    let near = f.at_most(f32x8::splat(simd, 1.0) - f).simd_lt(f32x8::splat(simd, 1e-4));
    let ahead = t.simd_lt(f32x8::splat(simd, 0.0)).select(f - 1.0, f);
    let still = t.abs().simd_lt(f32x8::splat(simd, 1e-6));
    (still.select(f32x8::splat(simd, 1e3), ahead / t), near)
}
