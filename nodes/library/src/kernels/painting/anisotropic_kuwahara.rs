//! The anisotropic Kuwahara filter with polynomial weighting functions (§ 5.4, Listing 5.4): the mean
//! of the sectors of an ellipse that lies along the local structure, flat sectors counting most.
//!
//! Eight neighbouring pixels go through the union of their ellipses, row by row, pixels outside their
//! own ellipse with weight 0. Two pixels opposite each other share one evaluation of the weights, and
//! sums over opposite sectors are kept as their sum and their difference: those need the sum and the
//! difference of the two colours only, which halves the multiply-adds. The weights of some rows are found
//! first, then the sums of some channels in all sectors at a time, which fit the registers.
//!
//! Cost: pi radius^2 pixels, each half of about 105 operations. The shader reads them through workgroup memory,
//! about (1 + elongation)^2 radius^2 / 4 loads a pixel, up to an elongation of 2.

pub use crate::kernels::shaders::anisotropic_kuwahara::Params;
use crate::kernels::shared::sectors::{INSIDE, MIN_RADIUS, Polynomial, Response, Sector};
use crate::kernels::shared::tensor::{anisotropy, tangent};
use crate::kernels::simd::moment_buffer::{CHANNELS, MomentBuffer, for_rows};
use crate::kernels::simd::pixels::{Block, eight, write};
use isophote_engine::apart;
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};
use std::f32::consts::FRAC_1_SQRT_2;

crate::kernel!(anisotropic_kuwahara {
    cpu: |simd, pass, params, band| filter(simd, pass, &params, band),
    cost: |p| {
        let sums = if p.sectors == 8 { 55.0 } else { 32.0 };
        60.0 + std::f64::consts::PI * f64::from(p.radius).powi(2) * sums
    },
    tolerance: Tolerance {
        absolute: 2e-3,
        relative: 1e-3,
        outliers: 0.03,
        reason: "the last bit decides whether a pixel on the border of the ellipse belongs to it, where the \
                 tensor is nearly isotropic its direction turns by many roundings, and the brightest pixels \
                 round the variances of all sectors",
    },
});

/// Options of the filter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Radius r, pixels.
    pub radius: f32,
    /// 4 or 8.
    pub sectors: u32,
    /// Exponent q.
    pub q: f32,
    /// tau_s, RGB in 0..=1.
    pub threshold: f32,
    /// alpha of (5.22): the ellipse is up to ((1 + alpha) / alpha)^2 times as long as wide.
    pub alpha: f32,
    /// tau_w of § 5.5.2.
    pub deviation_floor: f32,
}

/// Filters a colour. The second output (`sibling` 1) is the sum of the standard deviations of the
/// sectors, as of eight.
pub fn pass(plan: &mut PlanBuilder, color: ImageId, tensors: ImageId, options: &Options) -> ImageId {
    let radius = options.radius.max(MIN_RADIUS);
    let weights = Polynomial::new(radius, options.sectors);
    let params = Params {
        radius,
        elongation: 1.0 / options.alpha,
        zeta: weights.zeta,
        eta: weights.eta,
        threshold: options.threshold,
        q: options.q,
        deviation_floor: options.deviation_floor,
        sectors: options.sectors,
    };
    let level = plan.desc(color).level;
    let support = Support::Pixels(reach(radius, params.elongation) as u32);
    plan.pass_at(&KERNEL, &[color, tensors], &params, &[Class::Colour, Class::Field], support, level)
}

/// The most pixels that an ellipse reaches along either axis.
pub(crate) fn reach(radius: f32, elongation: f32) -> i32 {
    // The longest is (1 + elongation) radius; the margin is that of the border.
    (radius * (1.0 + elongation) * INSIDE.sqrt()).floor() as i32 + 1
}

/// One pair of opposite pixels: per pair of opposite sectors the sum and the difference of the polynomials,
/// then sums and differences of the pixels' channels, the Gaussian, and the sum of all polynomials. What makes
/// polynomials into weights is found and multiplied in where the sums are: all would wait for its division.
/// Aligned, so that no vector lies in two cache lines.
#[derive(Clone, Copy)]
#[repr(align(64))]
struct Tap([[f32; 8]; 20]);

/// Pairs of pixels that are collected before they are added up: with fewer, sums would often be begun
/// anew, and more would not stay in the first-level cache.
const BATCH: usize = 24;

const BOTH: usize = 0;
const APART: usize = 4;
const SUM: usize = 8;
const DIFFERENCE: usize = 13;
const NORM: usize = 18;
const TOTAL: usize = 19;

#[inline(always)]
fn filter<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, band: &mut Band<'_>) {
    let reach = reach(params.radius, params.elongation);
    let mut taps = vec![Tap([[0.0; 8]; 20]); BATCH + 2 * reach as usize];
    let color = &pass.inputs[0];
    for_rows(
        simd,
        color,
        reach,
        band,
        #[inline(always)]
        |planes, [x0, x1], y, band| {
            let opaque = planes.is_opaque();
            for x in (x0..x1).step_by(8) {
                let block = Block::until(x1, x, y);
                let ellipses = Ellipses::new(simd, params, block.read(simd, &pass.inputs[1]));
                let original = block.read(simd, color);
                let place = Place { planes, x, y };
                let response = match (opaque, params.sectors == 8) {
                    (true, true) => apart!(
                        simd,
                        filtered::<S, true, true>(simd, place, &ellipses, params, &mut taps, original),
                    ),
                    (false, true) => apart!(
                        simd,
                        filtered::<S, false, true>(simd, place, &ellipses, params, &mut taps, original),
                    ),
                    (true, false) => apart!(
                        simd,
                        filtered::<S, true, false>(simd, place, &ellipses, params, &mut taps, original),
                    ),
                    (false, false) => apart!(
                        simd,
                        filtered::<S, false, false>(simd, place, &ellipses, params, &mut taps, original),
                    ),
                };
                put_response(response, [x, x1.min(x + 8)], y, band);
            }
        },
    );
}

/// Writes the colours and the deviations of the pixels from `first` to before `end`.
#[inline(always)]
pub(super) fn put_response<S: Simd>(
    (colour, deviation): ([f32x8<S>; 4], f32x8<S>),
    [first, end]: [i32; 2],
    y: i32,
    band: &mut Band<'_>,
) {
    let x0 = band.window.x0;
    let (first, end) = ((first - x0) as usize, (end - x0) as usize);
    write(colour, &mut band.row_mut(0, y)[4 * first..4 * end]);
    band.row_mut(1, y)[first..end].copy_from_slice(&deviation.to_array()[..end - first]);
}

/// Eight pixels of a row and the rows around them.
#[derive(Clone, Copy)]
struct Place<'a> {
    planes: &'a MomentBuffer,
    x: i32,
    y: i32,
}

/// The mappings S R_-phi (5.32) of eight pixels, for discs of radius 1, and their ellipses
/// a i^2 + 2 b i j + c j^2 <= 1 solved for i.
struct Ellipses<S: Simd> {
    along: [f32x8<S>; 2],
    across: [f32x8<S>; 2],
    /// -b / a: how far the middle of a row lies from that of the row above.
    shift: f32x8<S>,
    /// 1 / a, and (a c - b^2) / a^2.
    width: [f32x8<S>; 2],
    /// Rows below the centre that hold a pixel of any.
    rows: i32,
}

impl<S: Simd> Ellipses<S> {
    #[inline(always)]
    fn new(simd: S, params: &Params, [e, f, g, _]: [f32x8<S>; 4]) -> Self {
        let [tx, ty] = tangent(e, f, g);
        let stretch = anisotropy(e, f, g) * params.elongation + 1.0;
        let long = f32x8::splat(simd, 1.0) / (stretch * params.radius);
        let short = stretch / params.radius;
        let along = [tx * long, ty * long];
        let across = [-(ty * short), tx * short];
        let a = along[0].mul_add(along[0], across[0] * across[0]);
        let b = along[0].mul_add(along[1], across[0] * across[1]);
        let area = params.radius.powi(4).recip();
        let inverse = f32x8::splat(simd, 1.0) / a;
        let rows = (a * (INSIDE / area)).sqrt().reduce_max() as i32;
        Self { along, across, shift: -(b * inverse), width: [inverse, inverse * inverse * area], rows }
    }

    /// First and last columns of eight rows from `j` on that hold a pixel of any of the ellipses.
    #[inline(always)]
    fn columns(&self, simd: S, j: i32) -> [[f32; 8]; 2] {
        let rows = f32x8::simd_from(simd, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]) + j as f32;
        let squares = rows * rows;
        let none = f32x8::splat(simd, -1e6);
        let (mut first, mut last) = (-none, none);
        let (shift, inverse) = (self.shift.to_array(), (self.width[0] * INSIDE).to_array());
        let width = (-self.width[1]).to_array();
        // The rows of one ellipse side by side, so that nothing is compared across a vector.
        for k in 0..8 {
            let middle = rows * shift[k];
            let square = squares.mul_add(f32x8::splat(simd, width[k]), f32x8::splat(simd, inverse[k]));
            let some = square.simd_ge(f32x8::splat(simd, 0.0));
            let half = some.select(square.at_least(0.0).sqrt() + 1e-3, none);
            first = first.at_most(middle - half);
            last = last.at_least(middle + half);
        }
        [first.ceil().to_array(), last.floor().to_array()]
    }
}

/// Sums that eight pixels gathered: per pair of opposite sectors those of both together and of their
/// difference, and the weights of each of the two.
struct Gathered<S: Simd> {
    both: [[f32x8<S>; 5]; 4],
    apart: [[f32x8<S>; 5]; 4],
    weights: [f32x8<S>; 4],
}

impl<S: Simd> Gathered<S> {
    /// Sector `k` (share 1/2) or its opposite (share -1/2).
    #[inline(always)]
    fn sector<const OPAQUE: bool>(&self, k: usize, share: f32) -> Sector<S> {
        let mut sums = [f32x8::splat(self.weights[0].simd, 0.0); 5];
        for channel in 0..5 {
            sums[channel] = self.apart[k][channel] * share + self.both[k][channel] * 0.5;
        }
        if OPAQUE {
            return Sector::opaque([sums[0], sums[1], sums[2], sums[3]], self.weights[k]);
        }
        Sector::new(sums, self.weights[k])
    }
}

/// Eight pixels: the response, and the sum of the sectors' standard deviations.
#[inline(always)]
fn filtered<S: Simd, const OPAQUE: bool, const EIGHT: bool>(
    simd: S,
    place: Place<'_>,
    ellipses: &Ellipses<S>,
    params: &Params,
    taps: &mut [Tap],
    original: [f32x8<S>; 4],
) -> ([f32x8<S>; 4], f32x8<S>) {
    let gathered = gather::<S, OPAQUE, EIGHT>(simd, place, ellipses, params, taps);
    let response = Response { threshold: params.threshold, q: params.q, floor: params.deviation_floor };
    // A loop, not closures: those the compiler leaves outside the code for wide vectors.
    let first = gathered.sector::<OPAQUE>(0, 0.5);
    if EIGHT {
        let mut sectors = [first; 8];
        for k in 0..4 {
            (sectors[k], sectors[k + 4]) =
                (gathered.sector::<OPAQUE>(k, 0.5), gathered.sector::<OPAQUE>(k, -0.5));
        }
        return response.of(&sectors, original);
    }
    let [b, c] = [gathered.sector::<OPAQUE>(0, -0.5), gathered.sector::<OPAQUE>(2, 0.5)];
    response.of(&[first, b, c, gathered.sector::<OPAQUE>(2, -0.5)], original)
}

/// Opaque pixels need no sums of coverage: those are the sums of weights, to the bit.
#[inline(always)]
fn gather<S: Simd, const OPAQUE: bool, const EIGHT: bool>(
    simd: S,
    place: Place<'_>,
    ellipses: &Ellipses<S>,
    params: &Params,
    taps: &mut [Tap],
) -> Gathered<S> {
    let zero = f32x8::splat(simd, 0.0);
    let Place { planes, x, y } = place;
    // At the centre all sectors weigh the same.
    let share = f32x8::splat(simd, if EIGHT { 0.125 } else { 0.25 });
    let at = planes.column(x);
    let mut centre = [zero; 5];
    for (centre, plane) in centre.iter_mut().zip(planes.row(y)) {
        *centre = eight(simd, plane, at) * (share + share);
    }
    let mut out = Gathered { both: [centre; 4], apart: [[zero; 5]; 4], weights: [share; 4] };
    let mut collected = 0;
    let mut columns = [[0.0; 8]; 2];
    for j in 0..=ellipses.rows {
        let row = j as usize % 8;
        if row == 0 {
            columns = ellipses.columns(simd, j);
        }
        let (first, last) = (if j == 0 { 1 } else { columns[0][row] as i32 }, columns[1][row] as i32);
        if first <= last {
            let count = (last - first + 1) as usize;
            let row = &mut taps[collected..collected + count];
            weights::<S, OPAQUE, EIGHT>(simd, place, ellipses, params, [first, j], row);
            collected += count;
        }
        if collected >= BATCH || j == ellipses.rows {
            let taps = &mut taps[..collected];
            add::<S, EIGHT, 0, 3>(simd, taps, [BOTH, SUM], &mut out.both);
            add::<S, EIGHT, 0, 3>(simd, taps, [APART, DIFFERENCE], &mut out.apart);
            add_squares::<S, EIGHT>(simd, taps, &mut out);
            if !OPAQUE {
                add::<S, EIGHT, 4, 5>(simd, taps, [BOTH, SUM], &mut out.both);
                add::<S, EIGHT, 4, 5>(simd, taps, [APART, DIFFERENCE], &mut out.apart);
            }
            collected = 0;
        }
    }
    out
}

/// Positions in eight unit discs along a row of pixels: in those of the even sectors, and turned by 45 degrees in
/// those of the odd ones.
///
/// All lengths are taken times eta, which makes the weights polynomials with a leading factor of 1. That of the
/// weights, eta squared, goes when they are normalised.
struct Row<S: Simd> {
    start: [f32x8<S>; 2],
    step: [f32x8<S>; 2],
    turned: [f32x8<S>; 2],
    turned_step: [f32x8<S>; 2],
    zeta: f32x8<S>,
    /// Factor and summand that make a squared distance of the sum of two polynomials.
    shrink: f32,
    middle: f32x8<S>,
}

impl<S: Simd> Row<S> {
    #[inline(always)]
    fn new(simd: S, ellipses: &Ellipses<S>, params: &Params, j: i32) -> Self {
        let (scale, shrink) = (params.eta, -(params.eta * params.eta).recip());
        let below_centre = scale * j as f32;
        let start = [ellipses.along[1] * below_centre, ellipses.across[1] * below_centre];
        let step = [ellipses.along[0] * scale, ellipses.across[0] * scale];
        Self {
            start,
            step,
            turned: [(start[0] + start[1]) * FRAC_1_SQRT_2, (start[1] - start[0]) * FRAC_1_SQRT_2],
            turned_step: [(step[0] + step[1]) * FRAC_1_SQRT_2, (step[1] - step[0]) * FRAC_1_SQRT_2],
            zeta: f32x8::splat(simd, params.zeta * params.eta),
            shrink,
            middle: f32x8::splat(simd, -2.0 * params.zeta * params.eta * shrink),
        }
    }

    /// Per pair of opposite sectors the sum and the difference of their polynomials, and the squared distance from
    /// the centre.
    #[inline(always)]
    fn pairs<const EIGHT: bool>(&self, simd: S, column: f32x8<S>) -> ([[f32x8<S>; 2]; 4], f32x8<S>) {
        let Self { start, step, turned, turned_step, zeta, .. } = self;
        let zero = f32x8::splat(simd, 0.0);
        let v = [column.mul_add(step[0], start[0]), column.mul_add(step[1], start[1])];
        let k0 = (-v[1]).mul_add(v[1], *zeta);
        let k2 = (-v[0]).mul_add(v[0], *zeta);
        let distance = (k0 + k2).mul_add(f32x8::splat(simd, self.shrink), self.middle);
        let mut pairs = [[zero; 2]; 4];
        pairs[0] = opposite(v[0], k0, zero);
        pairs[2] = opposite(v[1], k2, zero);
        if EIGHT {
            let u = [column.mul_add(turned_step[0], turned[0]), column.mul_add(turned_step[1], turned[1])];
            pairs[1] = opposite(u[0], (-u[1]).mul_add(u[1], *zeta), zero);
            pairs[3] = opposite(u[1], (-u[0]).mul_add(u[0], *zeta), zero);
        }
        (pairs, distance)
    }
}

/// Finds the weights of the pixels of row `j` from column `i` on, and pairs them with their opposites.
#[inline(always)]
fn weights<S: Simd, const OPAQUE: bool, const EIGHT: bool>(
    simd: S,
    place: Place<'_>,
    ellipses: &Ellipses<S>,
    params: &Params,
    [i, j]: [i32; 2],
    taps: &mut [Tap],
) {
    let Place { planes, x, y } = place;
    // What the row meets below, and above from its last pixel on.
    let last = taps.len() - 1;
    let (mut below, mut above) = (planes.row(y + j), planes.row(y - j));
    let (near, far) = (planes.column(x + i), planes.column(x - i) - last);
    for channel in 0..CHANNELS {
        below[channel] = &below[channel][near..near + last + 8];
        above[channel] = &above[channel][far..far + last + 8];
    }
    let row = Row::new(simd, ellipses, params, j);
    // Whole numbers. To add up positions instead would round them by where the union begins.
    let mut column = f32x8::splat(simd, i as f32);
    for (n, tap) in taps.iter_mut().enumerate() {
        let (pairs, distance) = row.pairs::<EIGHT>(simd, column);
        column += 1.0;
        let mut sum = pairs[0][0] + pairs[2][0];
        if EIGHT {
            sum += pairs[1][0] + pairs[3][0];
        }
        let inside = distance.simd_le(f32x8::splat(simd, INSIDE));
        inside.select(gaussian(distance), f32x8::splat(simd, 0.0)).store_slice(&mut tap.0[NORM]);
        // No sector may hold what lies outside the ellipse: 0 must not be divided by 0.
        sum.at_least(f32::MIN_POSITIVE).store_slice(&mut tap.0[TOTAL]);
        for k in 0..4 {
            if EIGHT || k % 2 == 0 {
                pairs[k][0].store_slice(&mut tap.0[BOTH + k]);
                pairs[k][1].store_slice(&mut tap.0[APART + k]);
            }
        }
        for channel in 0..if OPAQUE { 4 } else { 5 } {
            let p = eight(simd, below[channel], n);
            let q = f32x8::from_slice(simd, &above[channel][last - n..last - n + 8]);
            (p + q).store_slice(&mut tap.0[SUM + channel]);
            (p - q).store_slice(&mut tap.0[DIFFERENCE + channel]);
        }
    }
}

/// Sum and difference of the polynomials (5.36) of two opposite sectors, from the component along the
/// sector and zeta - eta times the square of that across it.
#[inline(always)]
fn opposite<S: Simd>(forward: f32x8<S>, k: f32x8<S>, zero: f32x8<S>) -> [f32x8<S>; 2] {
    let (near, far) = ((k + forward).at_least(zero), (k - forward).at_least(zero));
    let near = near * near;
    [far.mul_add(far, near), (-far).mul_add(far, near)]
}

/// exp(-3.125 x) for x in 0..=1 to 1e-6; the fourth power of a polynomial for a quarter of it.
#[inline(always)]
fn gaussian<S: Simd>(x: f32x8<S>) -> f32x8<S> {
    let c = |v: f32| f32x8::splat(x.simd, v);
    // In pairs, so that no more than three operations wait for each other.
    let xx = x * x;
    let high = x.mul_add(c(-0.001_649_391), c(0.014_706_744));
    let middle = x.mul_add(c(-0.079_063_355), c(0.305_081_35));
    let low = x.mul_add(c(-0.781_241_96), c(0.999_999_9));
    let p = xx.mul_add(high, middle).mul_add(xx, low);
    let p = p * p;
    p * p
}

/// Adds the channels from `FIRST` to before `LAST`, of sums or of differences, to all sectors: three
/// channels of four sectors fit the registers, and each value that is read serves all of them.
#[inline(always)]
fn add<S: Simd, const EIGHT: bool, const FIRST: usize, const LAST: usize>(
    simd: S,
    taps: &mut [Tap],
    [weight, value]: [usize; 2],
    sums: &mut [[f32x8<S>; 5]; 4],
) {
    let mut sum = *sums;
    for tap in taps {
        let mut norm = f32x8::from_slice(simd, &tap.0[NORM]);
        if value == SUM && FIRST == 0 {
            norm /= f32x8::from_slice(simd, &tap.0[TOTAL]);
            norm.store_slice(&mut tap.0[NORM]);
        }
        let mut values = [f32x8::splat(simd, 0.0); 3];
        for channel in FIRST..LAST {
            values[channel - FIRST] = f32x8::from_slice(simd, &tap.0[value + channel]) * norm;
        }
        // Twelve sums, three values and a weight: what the registers hold.
        for k in 0..4 {
            if EIGHT || k % 2 == 0 {
                let weight = f32x8::from_slice(simd, &tap.0[weight + k]);
                for channel in FIRST..LAST {
                    sum[k][channel] = weight.mul_add(values[channel - FIRST], sum[k][channel]);
                }
            }
        }
    }
    *sums = sum;
}

/// Adds the squares, and the weights themselves, to all sectors.
#[inline(always)]
fn add_squares<S: Simd, const EIGHT: bool>(simd: S, taps: &[Tap], out: &mut Gathered<S>) {
    const SQUARES: usize = 3;
    let (mut both, mut apart, mut weights) = (out.both, out.apart, out.weights);
    for tap in taps {
        let norm = f32x8::from_slice(simd, &tap.0[NORM]);
        let sum = f32x8::from_slice(simd, &tap.0[SUM + SQUARES]) * norm;
        let difference = f32x8::from_slice(simd, &tap.0[DIFFERENCE + SQUARES]) * norm;
        for k in 0..4 {
            if EIGHT || k % 2 == 0 {
                let s = f32x8::from_slice(simd, &tap.0[BOTH + k]);
                let d = f32x8::from_slice(simd, &tap.0[APART + k]);
                both[k][SQUARES] = s.mul_add(sum, both[k][SQUARES]);
                apart[k][SQUARES] = d.mul_add(difference, apart[k][SQUARES]);
                weights[k] = s.mul_add(norm, weights[k]);
            }
        }
    }
    (out.both, out.apart, out.weights) = (both, apart, weights);
}
