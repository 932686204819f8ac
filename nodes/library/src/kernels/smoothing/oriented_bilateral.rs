//! One pass of the orientation-aligned bilateral filter (§ 3.4, Listing 3.1), along the gradient or
//! along the tangent; the first pass of the flow-based bilateral filter (§ 3.5) is the same.
//!
//! Taps are one pixel apart along the axis that is nearer to the direction, so each lies between two
//! pixels (3.6, 3.7). The range is measured as Euclidean distance of the three colour channels, taps
//! count by their coverage, and coverage itself passes: the edge of a cut-out is an edge to preserve.
//!
//! Cost: about 1.8 cutoff taps of two loads, one interpolation and one exponential (manual: two).

use crate::kernels::blocks::for_blocks_in_tiles;
use crate::kernels::coverage::Covered;
use crate::kernels::support::{get_pixels4, put_pixels4};
use crate::kernels::tensor_algebra::{anisotropy, tangent};
use isophote_engine::fearless_simd::{Simd, dispatch, f32x4, f32x8, i32x8, mask32x8, prelude::*};
use isophote_engine::math::{Elementary, channels, load_pixel, load_pixels, spread, transposed};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance, View};

crate::params! {
    /// Uniform block.
    pub struct Params for oriented_bilateral {
        /// Standard deviation along the line, pixels.
        pub sigma_d: f32,
        /// Standard deviation of the range, in the unit of the colour.
        pub sigma_r: f32,
        /// Distance of the last tap, pixels.
        pub cutoff: f32,
        /// Growth of the tangent's scale, and shrinking of the gradient's, per unit of anisotropy.
        pub elongation: f32,
        /// 1: along the tangent; 0: along the gradient.
        pub tangential: u32,
        /// 1: range weights before the interpolation (3.9); 0: after it.
        pub manual: u32,
    }
}

crate::kernel!(oriented_bilateral {
    cpu: run,
    cost: |params| {
        let p: Params = bytemuck::pod_read_unaligned(params);
        1.8 * f64::from(p.cutoff) * if p.manual != 0 { 50.0 } else { 35.0 }
    },
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

/// Where range weights are applied.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sampling {
    /// To the interpolated colour.
    Linear = 0,
    /// To both pixels, before the interpolation (3.9).
    Manual = 1,
}

/// What a pass is asked for.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Standard deviation along the line, pixels.
    pub sigma_d: f32,
    /// Standard deviation of the range, in the unit of the colour.
    pub sigma_r: f32,
    /// Where range weights are applied.
    pub sampling: Sampling,
    /// Elongation per unit of anisotropy; 0 for none.
    pub elongation: f32,
}

/// Lines are cut at ceil(3 sigma_d) pixels (§ 3.4).
const PRECISION: f32 = 3.0;

/// Filters a colour, usually CIELAB, along one direction of the tensors.
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
        manual: options.sampling as u32,
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

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    let covered = (params.manual == 0).then(|| Covered::new(&pass.inputs[0], band, reach(&params)));
    let block = Blocks {
        params,
        origins: pass.inputs[0],
        source: covered.as_ref().map_or(pass.inputs[0], |c| c.view(&pass.inputs[0])),
        tensors: pass.inputs[1],
        opaque: covered.as_ref().is_some_and(Covered::is_opaque),
    };
    if block.opaque {
        dispatch!(pass.level, simd => block.rows::<_, true>(simd, band));
    } else {
        dispatch!(pass.level, simd => block.rows::<_, false>(simd, band));
    }
}

/// What all blocks of a band share.
struct Blocks<'a> {
    params: Params,
    origins: View<'a>,
    /// Colours times coverage for linear sampling, as they are for manual.
    source: View<'a>,
    tensors: View<'a>,
    /// All coverage is 1.
    opaque: bool,
}

/// Where the taps of eight lines lie.
#[derive(Clone, Copy)]
struct Lines<S: Simd> {
    x: i32x8<S>,
    y: i32x8<S>,
    /// Lanes whose axis nearer to the direction is x.
    along_x: mask32x8<S>,
    /// Advance along the other axis per pixel of that one.
    slope: f32x8<S>,
    /// Offset of the pixel in the middle, and offsets per pixel of the two axes.
    start: i32x8<S>,
    major: i32x8<S>,
    minor: i32x8<S>,
}

impl<S: Simd> Lines<S> {
    /// Offsets of the first of the two pixels around the taps `k` pixels along the axis, and the second
    /// one's share.
    #[inline(always)]
    fn first(&self, k: f32x8<S>) -> (i32x8<S>, f32x8<S>) {
        let o = self.slope * k;
        let i = o.floor();
        (self.start + self.major * k.to_int::<i32x8<S>>() + self.minor * i.to_int::<i32x8<S>>(), o - i)
    }
}

impl Blocks<'_> {
    /// All blocks; the compiler is told when all coverage is 1.
    #[inline(always)]
    fn rows<S: Simd, const OPAQUE: bool>(&self, simd: S, band: &mut Band<'_>) {
        let last = band.window.x1 - 1;
        for_blocks_in_tiles::<4>(band, #[inline(always)] |block, target| {
            put_pixels4(self.filtered::<S, OPAQUE>(simd, block.x, block.y, last), target);
        });
    }

    #[inline(always)]
    fn filtered<S: Simd, const OPAQUE: bool>(&self, simd: S, x: i32, y: i32, last: i32) -> [f32x8<S>; 4] {
        let params = &self.params;
        let [e, f, g, _] = get_pixels4(simd, &self.tensors, x, y, last);
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
        let domain = f32x8::splat(simd, -0.721_347_52) / (sigma_d * sigma_d).max(f32x8::splat(simd, 1e-6));
        let range = -0.721_347_52 / (params.sigma_r * params.sigma_r).max(1e-6);

        let origin = get_pixels4(simd, &self.origins, x, y, last);
        let alpha = origin[3];
        let mut sum = [origin[0] * alpha, origin[1] * alpha, origin[2] * alpha, alpha];
        let columns = i32x8::from_fn(simd, |lane| (x + lane as i32).min(last));
        let (held, stride) = (self.source.window(), self.source.stride() as i32);
        let (across, down) = (i32x8::splat(simd, 4), i32x8::splat(simd, stride));
        let lines = Lines {
            x: columns,
            y: i32x8::splat(simd, y),
            along_x,
            slope,
            start: (columns - held.x0) * 4 + (y - held.y0) * stride,
            major: along_x.select(across, down),
            minor: along_x.select(down, across),
        };
        // Away from the picture's edges no position needs to be clamped; where all lines take the same axis,
        // the second pixel of a tap is as far from the first in all lanes.
        let reach = reach(params);
        let [w, h] = self.source.full();
        let inner = x >= reach && y >= reach && x + 7 + reach < w && y + reach < h;
        let gap = if !inner || params.manual != 0 {
            None
        } else if along_x.all_true() {
            Some(stride as u32 as usize)
        } else if along_x.any_true() {
            None
        } else {
            Some(4)
        };
        if params.manual != 0 {
            let mut k = 1.0;
            while steps.simd_ge(k).any_true() {
                let domain = domain_at(domain, steps, k);
                for side in sides(steps, k) {
                    let (at, f) = if inner { self.inner(lines, side) } else { self.clamped(lines, side) };
                    let (a, b) = (self.pixels(simd, at[0]), self.pixels(simd, at[1]));
                    for (tap, share) in [(a, f32x8::splat(simd, 1.0) - f), (b, f)] {
                        let weight = (distance2(&tap, &origin) * range + domain).exp2() * share * tap[3];
                        sum[0] = weight.mul_add(tap[0], sum[0]);
                        sum[1] = weight.mul_add(tap[1], sum[1]);
                        sum[2] = weight.mul_add(tap[2], sum[2]);
                        sum[3] += weight;
                    }
                }
                k += 1.0;
            }
        } else {
            let mut k = 1.0;
            let mut more = steps.simd_ge(k).any_true();
            // Lines of no length read nothing: the pixel beside the centre may lie outside the support.
            let mut taps = [[f32x8::splat(simd, 0.0); 4]; 2];
            if more {
                taps = self.taps(simd, lines, sides(steps, k), inner, gap);
            }
            while more {
                // The next taps are fetched before these are weighted: exponentials are long chains of
                // operations, and the fetches fill the time.
                more = steps.simd_ge(k + 1.0).any_true();
                let next = if more {
                    self.taps(simd, lines, sides(steps, k + 1.0), inner, gap)
                } else {
                    taps
                };
                let domain = domain_at(domain, steps, k);
                let mut exponents = [domain; 2];
                for i in 0..2 {
                    let mut colour = taps[i];
                    if !OPAQUE {
                        let seen = f32x8::splat(simd, 1.0) / colour[3].max(f32x8::splat(simd, 1e-6));
                        colour = [colour[0] * seen, colour[1] * seen, colour[2] * seen, colour[3]];
                    }
                    exponents[i] += distance2(&colour, &origin) * range;
                }
                let weights = [exponents[0].exp2(), exponents[1].exp2()];
                for i in 0..2 {
                    let (weight, [r, g, b, a]) = (weights[i], taps[i]);
                    sum[0] = weight.mul_add(r, sum[0]);
                    sum[1] = weight.mul_add(g, sum[1]);
                    sum[2] = weight.mul_add(b, sum[2]);
                    sum[3] = if OPAQUE { sum[3] + weight } else { weight.mul_add(a, sum[3]) };
                }
                taps = next;
                k += 1.0;
            }
        }
        let seen = sum[3].simd_gt(f32x8::splat(simd, 1e-6));
        [
            seen.select(sum[0] / sum[3], origin[0]),
            seen.select(sum[1] / sum[3], origin[1]),
            seen.select(sum[2] / sum[3], origin[2]),
            alpha,
        ]
    }

    /// Interpolated taps on both sides.
    #[inline(always)]
    fn taps<S: Simd>(
        &self,
        simd: S,
        lines: Lines<S>,
        sides: [f32x8<S>; 2],
        inner: bool,
        gap: Option<usize>,
    ) -> [[f32x8<S>; 4]; 2] {
        if let Some(gap) = gap {
            let places = [lines.first(sides[0]), lines.first(sides[1])];
            return [
                self.apart(simd, places[0].0.to_array(), gap, places[0].1),
                self.apart(simd, places[1].0.to_array(), gap, places[1].1),
            ];
        }
        let places = if inner {
            [self.inner(lines, sides[0]), self.inner(lines, sides[1])]
        } else {
            [self.clamped(lines, sides[0]), self.clamped(lines, sides[1])]
        };
        [self.between(simd, places[0].0, places[0].1), self.between(simd, places[1].0, places[1].1)]
    }

    /// Offsets of the two pixels around the taps `k` pixels along the axis, and the second one's share.
    #[inline(always)]
    fn inner<S: Simd>(&self, lines: Lines<S>, k: f32x8<S>) -> ([[i32; 8]; 2], f32x8<S>) {
        let (at, f) = lines.first(k);
        ([at.to_array(), (at + lines.minor).to_array()], f)
    }

    /// As [`Blocks::inner`], with positions clamped to the picture.
    #[inline(always)]
    fn clamped<S: Simd>(&self, lines: Lines<S>, k: f32x8<S>) -> ([[i32; 8]; 2], f32x8<S>) {
        let simd = lines.slope.simd;
        let o = lines.slope * k;
        let i = o.floor();
        let (k, i): (i32x8<S>, i32x8<S>) = (k.to_int(), i.to_int());
        let [w, h] = self.source.full();
        let (x, y) = (lines.along_x.select(k, i), lines.along_x.select(i, k));
        let next = lines.along_x.select(i32x8::splat(simd, 0), i32x8::splat(simd, 1));
        let (x, y) = (lines.x + x, lines.y + y);
        let a = self.offset(simd, x, y, [w, h]);
        let b = self.offset(simd, x + next, y + (i32x8::splat(simd, 1) - next), [w, h]);
        ([a, b], o - o.floor())
    }

    #[inline(always)]
    fn offset<S: Simd>(&self, simd: S, x: i32x8<S>, y: i32x8<S>, [w, h]: [i32; 2]) -> [i32; 8] {
        let held = self.source.window();
        let zero = i32x8::splat(simd, 0);
        let x = x.max(zero).min(i32x8::splat(simd, w - 1)) - held.x0;
        let y = y.max(zero).min(i32x8::splat(simd, h - 1)) - held.y0;
        (y * self.source.stride() as i32 + x * 4).to_array()
    }

    /// Interpolated taps.
    #[inline(always)]
    fn between<S: Simd>(&self, simd: S, at: [[i32; 8]; 2], f: f32x8<S>) -> [f32x8<S>; 4] {
        let (data, f) = (self.source.data(), spread(f));
        let mut pixels = [f32x8::splat(simd, 0.0); 4];
        for (i, pixel) in pixels.iter_mut().enumerate() {
            let a = load_pixel(simd, data, at[0][i]).combine(load_pixel(simd, data, at[0][i + 4]));
            let b = load_pixel(simd, data, at[1][i]).combine(load_pixel(simd, data, at[1][i + 4]));
            *pixel = (b - a).mul_add(f[i], a);
        }
        transposed(pixels)
    }

    /// Interpolated taps whose second pixels lie `gap` values behind the first: one place to look up.
    #[inline(always)]
    fn apart<S: Simd>(&self, simd: S, at: [i32; 8], gap: usize, f: f32x8<S>) -> [f32x8<S>; 4] {
        let (data, f) = (self.source.data(), spread(f));
        // Two slices of one length share the check of the range.
        let (first, second) = (&data[..data.len() - gap], &data[gap..]);
        let mut pixels = [f32x8::splat(simd, 0.0); 4];
        for i in 0..4 {
            let (low, high) = (at[i] as u32 as usize, at[i + 4] as u32 as usize);
            let a = load_pixels(simd, &first[low..low + 4], &first[high..high + 4]);
            let b = load_pixels(simd, &second[low..low + 4], &second[high..high + 4]);
            pixels[i] = (b - a).mul_add(f[i], a);
        }
        transposed(pixels)
    }

    /// The pixels at eight offsets.
    #[inline(always)]
    fn pixels<S: Simd>(&self, simd: S, at: [i32; 8]) -> [f32x8<S>; 4] {
        let data = self.source.data();
        let mut pixels = [f32x4::splat(simd, 0.0); 8];
        for lane in 0..8 {
            pixels[lane] = load_pixel(simd, data, at[lane]);
        }
        channels(pixels)
    }
}

/// Positions of tap `k` on both sides; lines that have ended stay within the support.
#[inline(always)]
fn sides<S: Simd>(steps: f32x8<S>, k: f32) -> [f32x8<S>; 2] {
    let reached = steps.min(k);
    [-reached, reached]
}

/// Exponent of the domain weight of tap `k`. Lines that have ended count for nothing: far below what a
/// float can add to the sum.
#[inline(always)]
fn domain_at<S: Simd>(domain: f32x8<S>, steps: f32x8<S>, k: f32) -> f32x8<S> {
    steps.simd_ge(k).select(domain * (k * k), f32x8::splat(steps.simd, -1e3))
}

/// Squared Euclidean distance of the three colour channels.
#[inline(always)]
fn distance2<S: Simd>(a: &[f32x8<S>; 4], b: &[f32x8<S>; 4]) -> f32x8<S> {
    let d = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    d[2].mul_add(d[2], d[1].mul_add(d[1], d[0] * d[0]))
}
