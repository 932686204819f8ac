//! Adds lines where geometry breaks to the response of the first pass of the flow-based difference of
//! Gaussians, so that the second pass smooths both kinds along the same flow.
//!
//! Across the tangent it finds the breaks of normal, depth or object id between successive pixels, and
//! takes a difference of Gaussians of their density off the response; the result is a line centred on
//! the break, as wide as those of the difference of Gaussians. Where breaks are as dense as the pixels
//! nothing stands out, and no line is drawn; creases that are as dense as lines are wide, such as the flutes of columns far
//! away, fade out before they run into one another. The thesis has no guides; this is the reasoning of § 4.5 applied to geometry.
//!
//! Creases, which lie between two normals, outlines, where normals, depth or object ids end, and borders of object ids
//! between things that touch, where depth goes on, have widths and strengths of their own.
//!
//! Cost: per step (12 sigma_e of them) up to three reads and two exponentials; four where the widths differ.

use crate::kernels::lines::flow_dog_gradient::{Across, MOST, directed};
pub use crate::kernels::shaders::guide_lines::Params;
use crate::kernels::shared::breaks::{
    APART, depth_apart, depth_bend, depth_break, depths, ids, nearness, normal_break, normals,
};
use crate::kernels::simd::pixels::{for_blocks, write};
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::math::Elementary;
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance, View};

crate::kernel!(guide_lines {
    cpu: |simd, pass, params, band| breaks(simd, pass, &params, band),
    cost: |p| f64::from(p.steps) * 2.0 * 60.0 + 60.0,
    tolerance: Tolerance {
        absolute: 1e-3,
        relative: 1e-4,
        outliers: 1e-2,
        reason: "guides are read at the nearest pixel, and which one is nearest, or the last within the \
                 cut-off, may turn on the last bit of the slope",
    },
});

/// Response, in units of L, that a unit of the difference of Gaussians takes off at weight 1: next to a
/// lone break, where the difference is 0.17, the line is as dark as at a step of about 35 units of L, so that
/// silhouettes are drawn where the ground is light, too.
const AMOUNT: f32 = 22.0;

/// Standard deviations, in those of the line filter: the Gaussians cross 1.8 of them from the break, so
/// that lines are as wide as those of lightness.
const NARROW: f32 = 1.2;
const WIDE: f32 = 3.0;

/// Cut-off in standard deviations of the wider Gaussian.
const PRECISION: f32 = 2.0;

/// Creases within a line's reach on each of its sides, counted by the wider Gaussian, from which on they are fainter, and at which
/// none is drawn: more would run into one another, and flicker. Where they begin and end they are drawn.
const FEW: f32 = 0.8;
const MANY: f32 = 1.5;

/// Kinds of lines that guides draw: creases, outlines, and borders between things that touch.
pub const KINDS: usize = 3;

const CREASE: usize = 0;
/// Place of outlines among the kinds.
pub const OUTLINE: usize = 1;
const BORDER: usize = 2;

/// Bit of `guides` where borders between things that touch are no outlines.
const TELLS: u32 = 8;

/// Options of lines that guides draw.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Standard deviation of the narrower Gaussian across lines of creases, of outlines and of borders between things that
    /// touch, pixels: half of one at least, since of a much narrower one no tap but the two next to the pixel has any weight.
    pub sigmas: [f32; KINDS],
    /// Strength of the same lines; 0 draws none of them.
    pub weights: [f32; KINDS],
    /// Weight of the difference of Gaussians in the response, tau or p.
    pub edge: f32,
    /// The fourth channel of the field is a factor on `sigmas`, [`MOST`] at the most.
    pub scaled: bool,
}

/// `response` (u alpha, alpha) with lines of strength `weights` where the guides, that is normal, depth
/// and object id as far as there are any, break; `edge` is the weight of the difference of Gaussians
/// in the response.
pub fn pass(
    plan: &mut PlanBuilder,
    response: ImageId,
    field: ImageId,
    guides: [Option<ImageId>; 3],
    options: &Options,
) -> ImageId {
    let Options { sigmas, weights, edge, scaled } = *options;
    // A lone break is the fainter the wider it is smoothed.
    let evened = |sigma: f32| if sigma < 1.0 { sigma.sqrt() } else { sigma };
    let sigmas = sigmas.map(|sigma| sigma.min(100.0));
    let amount = [0, 1, 2].map(|kind| AMOUNT * weights[kind] * edge * evened(sigmas[kind]));
    let falloff = |factor: f32| sigmas.map(|sigma| -0.5 / (factor * sigma * factor * sigma));
    let halfwidth = sigmas.map(|sigma| PRECISION * WIDE * sigma);
    let most = if scaled { MOST } else { 1.0 };
    let steps = (widest(&halfwidth) * most + 0.5) as i32;
    // What touches what is known by depth; without it all borders are outlines.
    let tells = (sigmas[BORDER], weights[BORDER]) != (sigmas[OUTLINE], weights[OUTLINE])
        && guides[1].is_some()
        && guides[2].is_some();
    let given: u32 = (0..3).map(|i| u32::from(guides[i].is_some()) << i).sum();
    let four = |[crease, outline, border]: [f32; KINDS]| [crease, outline, border, 0.0];
    let params = Params {
        narrow: four(falloff(NARROW)),
        wide: four(falloff(WIDE)),
        halfwidth: four(halfwidth),
        amount: four(amount),
        steps,
        guides: given | if tells { TELLS } else { 0 },
        scaled: scaled.into(),
        padding: Default::default(),
    };
    // A guide that is not there is not read; any image may stand in for it.
    let [normal, depth, id] = guides.map(|guide| guide.unwrap_or(response));
    // The bend of depth at the last pixel looks at one more, and what touches what is seen at three more.
    let support = Support::Pixels(steps as u32 + if tells { 3 } else { 1 });
    plan.pass(&KERNEL, &[response, field, normal, depth, id], &params, Class::Field, support)
}

/// The largest of the values of the kinds.
#[inline(always)]
fn widest(of: &[f32]) -> f32 {
    of[CREASE].max(of[OUTLINE]).max(of[BORDER])
}

#[inline(always)]
fn breaks<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, band: &mut Band<'_>) {
    let [response, field, normal, depth, object_id] = pass.inputs else { return };
    for_blocks::<2>(
        band,
        #[inline(always)]
        |block, target| {
            let (orientation, factor) = directed(simd, &block, field, params.scaled != 0);
            let line = Across::new(simd, &block, orientation);
            let strength = strength(simd, [normal, depth, object_id], params, &line, factor);
            let [u, alpha] = block.read(simd, response);
            write([u - strength * alpha, alpha], target);
        },
    );
}

/// Amount that breaks of any guide take off the response where they are stronger near eight pixels than around them.
#[inline(always)]
fn strength<S: Simd>(
    simd: S,
    [normal, depth, object_id]: [&View<'_>; 3],
    params: &Params,
    line: &Across<S>,
    factor: f32x8<S>,
) -> f32x8<S> {
    let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
    let has = |bit: u32| params.guides & bit != 0;
    let steps = steps(params, factor);
    let widths_a_step = line.step / factor;
    let first = -steps;
    let start = line.nearest(first);
    let mut normal_here = if has(1) { normals(simd, normal, start) } else { [zero; 3] };
    let mut id_here = if has(4) { ids(simd, object_id, start) } else { zero };
    let (mut depth_here, mut depth_next, mut bend_here) = (zero, zero, zero);
    if has(2) {
        depth_here = depths(simd, depth, start);
        depth_next = depths(simd, depth, line.nearest(first + 1));
        bend_here = depth_bend(depths(simd, depth, line.nearest(first - 1)), depth_here, depth_next);
    }
    let mut sums = [GuideSums::new(simd), GuideSums::new(simd), GuideSums::new(simd)];
    let is_uniform = params.halfwidth[CREASE] == params.halfwidth[OUTLINE];
    for k in first..steps {
        let next = line.nearest(k + 1);
        let mut found = [zero; 4];
        if has(1) {
            let normal_next = normals(simd, normal, next);
            [found[0], found[1]] = normal_break(normal_here, normal_next);
            normal_here = normal_next;
        }
        if has(2) {
            let after = depths(simd, depth, line.nearest(k + 2));
            let bend_next = depth_bend(depth_here, depth_next, after);
            found[2] = depth_break(bend_here, bend_next);
            (depth_here, depth_next, bend_here) = (depth_next, after, bend_next);
        }
        if has(4) {
            let id_next = ids(simd, object_id, next);
            found[3] = id_next.simd_eq(id_here).select(zero, one);
            id_here = id_next;
        }
        let d = widths_a_step * (k as f32 + 0.5);
        let weights = weights(d, params, CREASE);
        let others = if is_uniform { weights } else { self::weights(d, params, OUTLINE) };
        if has(TELLS) {
            let touching = found[3] * touching(simd, depth, line, k);
            sums[BORDER].add([touching, zero, zero], self::weights(d, params, BORDER));
            // A border is no crease as well.
            found[0] *= one - touching;
            found[3] -= touching;
        }
        sums[CREASE].add([found[0], zero, zero], weights);
        sums[CREASE].pass_by(k);
        sums[OUTLINE].add([found[1], found[2], found[3]], others);
    }
    // A lone break is the fainter the wider it is smoothed.
    let evened = factor.simd_ge(1.0).select(factor, factor.sqrt());
    strongest(&sums, params) * evened
}

/// Steps on each side, beyond which no pixel of the eight has a weight.
#[inline(always)]
fn steps<S: Simd>(params: &Params, factor: f32x8<S>) -> i32 {
    if params.scaled == 0 {
        return params.steps;
    }
    ((factor.reduce_max() * widest(&params.halfwidth) + 0.5) as i32).min(params.steps)
}

/// Amount of the strongest of the kinds.
#[inline(always)]
fn strongest<S: Simd>(sums: &[GuideSums<S>; KINDS], params: &Params) -> f32x8<S> {
    let creases = sums[CREASE].ridge() * params.amount[CREASE] * sums[CREASE].sparseness();
    let outlines = sums[OUTLINE].ridge() * params.amount[OUTLINE];
    let strongest = creases.at_least(outlines);
    if params.guides & TELLS == 0 {
        return strongest;
    }
    strongest.at_least(sums[BORDER].ridge() * params.amount[BORDER])
}

/// 1 where the surfaces at two successive pixels of the line touch, and 0 elsewhere.
#[inline(always)]
fn touching<S: Simd>(simd: S, depth: &View<'_>, line: &Across<S>, k: i32) -> f32x8<S> {
    let mut nearnesses = [f32x8::splat(simd, 0.0); 4];
    for (value, at) in nearnesses.iter_mut().zip([k - 3, k - 1, k + 2, k + 4]) {
        *value = nearness(depths(simd, depth, line.nearest(at)));
    }
    let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
    depth_apart(nearnesses).simd_lt(APART).select(one, zero)
}

/// Weights of the narrower and of the wider Gaussian at a distance, of one kind.
#[inline(always)]
fn weights<S: Simd>(d: f32x8<S>, params: &Params, kind: usize) -> [f32x8<S>; 2] {
    let near = d.abs().simd_le(params.halfwidth[kind]);
    let zero = f32x8::splat(d.simd, 0.0);
    let [narrow, wide] = [d * params.narrow[kind] * d, d * params.wide[kind] * d];
    [near.select(narrow.exp(), zero), near.select(wide.exp(), zero)]
}

/// Weighted sums of the breaks of three guides.
#[derive(Clone, Copy)]
struct GuideSums<S: Simd> {
    narrow: [f32x8<S>; 3],
    wide: [f32x8<S>; 3],
    weights: [f32x8<S>; 2],
    /// The wider sum of the first guide on one side of the pixel.
    before: f32x8<S>,
}

impl<S: Simd> GuideSums<S> {
    #[inline(always)]
    fn new(simd: S) -> Self {
        let zero = f32x8::splat(simd, 0.0);
        Self { narrow: [zero; 3], wide: [zero; 3], weights: [zero; 2], before: zero }
    }

    #[inline(always)]
    fn add(&mut self, found: [f32x8<S>; 3], [narrow, wide]: [f32x8<S>; 2]) {
        for (i, found) in found.iter().enumerate() {
            self.narrow[i] = narrow.mul_add(*found, self.narrow[i]);
            self.wide[i] = wide.mul_add(*found, self.wide[i]);
        }
        self.weights[0] += narrow;
        self.weights[1] += wide;
    }

    /// Keeps what lies before the pixel, which follows on step -1.
    #[inline(always)]
    fn pass_by(&mut self, k: i32) {
        if k == -1 {
            self.before = self.wide[0];
        }
    }

    /// 1 where few of the first guide's breaks are on a side of the pixel, and less where many are on both.
    #[inline(always)]
    fn sparseness(self) -> f32x8<S> {
        let fewer = self.before.at_most(self.wide[0] - self.before);
        let t = ((fewer - FEW) * (1.0 / (MANY - FEW))).within(0.0, 1.0);
        1.0 - t * t * (3.0 - t * 2.0)
    }

    /// By how much the breaks of any guide are denser near the pixel than around it.
    #[inline(always)]
    fn ridge(self) -> f32x8<S> {
        let mut ridge = f32x8::splat(self.weights[0].simd, 0.0);
        for (narrow, wide) in self.narrow.iter().zip(&self.wide) {
            ridge = ridge.at_least(*narrow / self.weights[0] - *wide / self.weights[1]);
        }
        ridge
    }
}
