//! The generalized Kuwahara filter (§ 5.3): the mean of the sectors of a disc, flat sectors counting
//! most.
//!
//! The sums over sectors are convolutions with fixed masks. Summed in the spatial domain, each sector
//! goes through the pixels where it has any weight. By the fast Fourier transform (§ 5.3.2),
//! blocks at fixed places are transformed, two real channels to a complex one, multiplied by the masks'
//! spectra and transformed back. Rounding then spreads over a block: one with highlights is transformed
//! in double precision.
//!
//! Cost: 5 multiply-adds for about 0.45 pi radius^2 pixels of each sector; transformed, about
//! 10 log2(block) operations for each of 18 transforms. The shader goes through the disc pixel by pixel, through
//! workgroup memory: about radius^2 / 4 loads.

pub use crate::kernels::shaders::generalized_kuwahara::Params;
use crate::kernels::shared::sampled_sectors::{sample, table};
use crate::kernels::shared::sectors::{INSIDE, MIN_RADIUS, Response, Sector};
use crate::kernels::simd::moment_buffer::{CHANNELS, for_rows};
use crate::kernels::simd::pixels::{Block, eight, read, write};
use block_convolution::{Convolution, Mask, Real, Reals, Square, block_side};
use isophote_engine::fearless_simd::{Level, Simd, dispatch, f32x8, f64x4, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance, View, memory};
use std::f32::consts::FRAC_1_SQRT_2;

#[path = "generalized_kuwahara/block_convolution.rs"]
mod block_convolution;

crate::kernel!(generalized_kuwahara {
    cpu: run,
    cost: |p| 60.0 + 7.0 / f64::from(p.scale).powi(2) * f64::from(p.sectors),
    tolerance: Tolerance {
        absolute: 2e-3,
        relative: 2e-3,
        outliers: 0.03,
        reason: "variances are differences of sums of hundreds of products, which the brightest pixels round, \
                 and the sectors of least variance win by its eighth power",
    },
});

/// Blocks whose squares exceed this are transformed in double precision.
const BRIGHT: f32 = 8.0;

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
    /// By the fast Fourier transform, on the CPU.
    pub fft: bool,
}

/// Filters a colour.
pub fn pass(plan: &mut PlanBuilder, color: ImageId, options: &Options) -> ImageId {
    let radius = options.radius.max(MIN_RADIUS);
    let reach = (radius * INSIDE.sqrt()).floor() as i32;
    let block = if options.fft { block_side(reach) as u32 } else { 0 };
    let params = Params {
        scale: 1.0 / radius,
        reach,
        threshold: options.threshold,
        q: options.q,
        sectors: options.sectors,
        block,
        padding: Default::default(),
        weights: *table(options.sectors),
    };
    // A pixel may lie at the far end of its block.
    let support = if options.fft { block as i32 - reach - 1 } else { reach };
    plan.pass(&KERNEL, &[color], &params, Class::Colour, Support::Pixels(support as u32))
}

impl Params {
    /// The masks of all sectors; the even ones first.
    fn masks(&self, level: Level) -> Vec<Mask> {
        let mut masks = vec![Mask::new(); self.sectors as usize];
        for y in -self.reach..=self.reach {
            for x in -self.reach..=self.reach {
                let (u, v) = (x as f32 * self.scale, y as f32 * self.scale);
                if u * u + v * v > INSIDE {
                    continue;
                }
                let turned = [(u + v) * FRAC_1_SQRT_2, (v - u) * FRAC_1_SQRT_2];
                let [even, odd] = dispatch!(level, simd => [
                    sample(simd, &self.weights, u, v).to_array(),
                    sample(simd, &self.weights, turned[0], turned[1]).to_array(),
                ]);
                for (mask, weight) in masks.iter_mut().zip(even.into_iter().chain(odd)) {
                    if weight > 0.0 {
                        mask.push(([x, y], weight));
                    }
                }
            }
        }
        masks
    }

    fn response(&self) -> Response {
        Response { threshold: self.threshold, q: self.q, floor: 0.0 }
    }
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    let masks = params.masks(pass.level);
    match (params.block, params.sectors) {
        (0, 8) => dispatch!(pass.level, simd => spatial::<_, 8>(simd, pass, &params, &masks, band)),
        (0, _) => dispatch!(pass.level, simd => spatial::<_, 4>(simd, pass, &params, &masks, band)),
        (_, 8) => dispatch!(pass.level, simd => by_blocks::<_, 8>(simd, pass, &params, &masks, band)),
        _ => dispatch!(pass.level, simd => by_blocks::<_, 4>(simd, pass, &params, &masks, band)),
    }
}

#[inline(always)]
fn spatial<S: Simd, const N: usize>(
    simd: S,
    pass: &CpuPass<'_>,
    params: &Params,
    masks: &[Mask],
    band: &mut Band<'_>,
) {
    let (x_start, reach, response) = (band.window.x0, params.reach, params.response());
    for_rows(
        simd,
        &pass.inputs[0],
        reach,
        band,
        #[inline(always)]
        |planes, [x0, x1], y, band| {
            let rows: Vec<[&[f32]; CHANNELS]> = (-reach..=reach).map(|j| planes.row(y + j)).collect();
            let opaque = planes.is_opaque();
            let zero = f32x8::splat(simd, 0.0);
            for x in (x0..x1).step_by(16) {
                let at = planes.column(x);
                let none = Sector::new([zero; 5], zero);
                let mut sectors = [[none; N]; 2];
                for (k, mask) in masks.iter().take(N).enumerate() {
                    let [a, b] = if opaque {
                        sector::<S, true>(simd, &rows, mask, reach, at)
                    } else {
                        sector::<S, false>(simd, &rows, mask, reach, at)
                    };
                    (sectors[0][k], sectors[1][k]) = (a, b);
                }
                for (half, sectors) in sectors.iter().enumerate() {
                    let x = x + 8 * half as i32;
                    if x >= x1 {
                        break;
                    }
                    let original = Block::until(x1, x, y).read(simd, &pass.inputs[0]);
                    let (colour, _) = response.of(sectors, original);
                    let (first, last) = ((x - x_start) as usize, (x1.min(x + 8) - x_start) as usize);
                    write(colour, &mut band.row_mut(0, y)[4 * first..4 * last]);
                }
            }
        },
    );
}

/// One sector of sixteen pixels. Opaque pixels need no sum of coverage: it is that of the weights.
#[inline(always)]
fn sector<S: Simd, const OPAQUE: bool>(
    simd: S,
    rows: &[[&[f32]; CHANNELS]],
    mask: &Mask,
    reach: i32,
    at: usize,
) -> [Sector<S>; 2] {
    let mut sums = [[f32x8::splat(simd, 0.0); 5]; 2];
    let mut total = 0.0;
    for ([dx, dy], weight) in mask {
        let row = &rows[(dy + reach) as usize];
        let start = (at as i32 + dx) as usize;
        let w = f32x8::splat(simd, *weight);
        for channel in 0..if OPAQUE { 4 } else { 5 } {
            let values = &row[channel][start..start + 16];
            sums[0][channel] = w.mul_add(f32x8::from_slice(simd, &values[..8]), sums[0][channel]);
            sums[1][channel] = w.mul_add(f32x8::from_slice(simd, &values[8..]), sums[1][channel]);
        }
        total += weight;
    }
    let total = f32x8::splat(simd, total);
    if OPAQUE {
        (sums[0][4], sums[1][4]) = (total, total);
    }
    [Sector::new(sums[0], total), Sector::new(sums[1], total)]
}

/// Sums of all sectors over the pixels that one block yields: per sector the channels of [`MomentBuffer`],
/// rows `stride` apart.
struct Sums {
    values: Vec<f32>,
    kept: usize,
    stride: usize,
}

impl Sums {
    fn channel(&mut self, sector: usize, channel: usize) -> &mut [f32] {
        let len = self.stride * self.kept;
        &mut self.values[(sector * CHANNELS + channel) * len..][..len]
    }
}

#[inline(always)]
fn by_blocks<S: Simd, const N: usize>(
    simd: S,
    pass: &CpuPass<'_>,
    params: &Params,
    masks: &[Mask],
    band: &mut Band<'_>,
) {
    let (side, reach) = (params.block as usize, params.reach);
    let kept = side - 2 * reach as usize;
    let stride = kept.next_multiple_of(8);
    let mut sums = Sums { values: Vec::new(), kept, stride };
    memory::resize(&mut sums.values, N * CHANNELS * stride * kept, 0.0);
    let mut single: Convolution<S, f32x8<S>> = Convolution::new(simd, side, masks);
    let mut double: Option<Convolution<S, f64x4<S>>> = None;
    let totals: Vec<f32> = masks.iter().map(|m| m.iter().map(|(_, w)| w).sum()).collect();
    let mut planes = vec![Vec::new(); CHANNELS];
    let step = kept as i32;
    let window = band.window;
    for by in (window.y0.div_euclid(step)..=(window.y1 - 1).div_euclid(step)).map(|b| b * step) {
        for bx in (window.x0.div_euclid(step)..=(window.x1 - 1).div_euclid(step)).map(|b| b * step) {
            let [opaque, bright] = block(&pass.inputs[0], [bx - reach, by - reach], side, &mut planes);
            if bright {
                let double = double.get_or_insert_with(|| Convolution::new(simd, side, masks));
                convolve(double, &planes, N, opaque, reach as usize, &mut sums);
            } else {
                convolve(&mut single, &planes, N, opaque, reach as usize, &mut sums);
            }
            if opaque {
                for (k, total) in totals.iter().enumerate() {
                    sums.channel(k, 4).fill(*total);
                }
            }
            respond::<_, N>(simd, pass, params, &sums, &totals, [bx, by], band);
        }
    }
}

/// The channels of a block from pixel `x0`, `y0` on; whether all of it is opaque, and whether some is
/// bright.
fn block(view: &View<'_>, [x0, y0]: [i32; 2], side: usize, planes: &mut [Vec<f32>]) -> [bool; 2] {
    let mut scratch = Vec::new();
    let (mut opaque, mut bright) = (true, false);
    planes.iter_mut().for_each(Vec::clear);
    for y in y0..y0 + side as i32 {
        for p in view.padded_row(y, x0, x0 + side as i32, &mut scratch).chunks_exact(4) {
            let square = p[3] * (p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
            opaque &= p[3] == 1.0;
            bright |= square > BRIGHT;
            let values = [p[0] * p[3], p[1] * p[3], p[2] * p[3], square, p[3]];
            for (plane, value) in planes.iter_mut().zip(values) {
                plane.push(value);
            }
        }
    }
    [opaque, bright]
}

#[inline(always)]
fn convolve<S: Simd, V: Reals<S>>(
    convolution: &mut Convolution<S, V>,
    planes: &[Vec<f32>],
    sectors: usize,
    opaque: bool,
    reach: usize,
    sums: &mut Sums,
) {
    let (kept, stride) = (sums.kept, sums.stride);
    let side = kept + 2 * reach;
    let values = |plane: &[f32]| plane.iter().map(|v| V::Element::near(f64::from(*v))).collect();
    let mut product = Square::new(side);
    // Two channels at a time are the real and the imaginary part.
    for pair in [[0, 1], [2, 3], [4, 4]].into_iter().take(if opaque { 2 } else { 3 }) {
        let mut spectrum = Square { real: values(&planes[pair[0]]), imaginary: values(&planes[pair[1]]) };
        convolution.spectrum(&mut spectrum);
        for k in 0..sectors {
            convolution.convolved(&spectrum, k, reach..side - reach, &mut product);
            for (channel, part) in pair.into_iter().zip([&product.real, &product.imaginary]) {
                let rows = sums.channel(k, channel).chunks_exact_mut(stride);
                for (row, target) in rows.enumerate() {
                    let source = &part[(row + reach) * side + reach..][..kept];
                    for (target, value) in target.iter_mut().zip(source) {
                        let value: f64 = (*value).into();
                        *target = value as f32;
                    }
                }
            }
        }
    }
}

/// Writes the part of a block that lies in the band.
#[inline(always)]
fn respond<S: Simd, const N: usize>(
    simd: S,
    pass: &CpuPass<'_>,
    params: &Params,
    sums: &Sums,
    totals: &[f32],
    [bx, by]: [i32; 2],
    band: &mut Band<'_>,
) {
    let (window, kept, response) = (band.window, sums.kept as i32, params.response());
    let plane = sums.stride * sums.kept;
    for y in by.max(window.y0)..(by + kept).min(window.y1) {
        for x in (bx..(bx + kept).min(window.x1)).step_by(8) {
            let (first, last) = (x.max(window.x0), (x + 8).min(bx + kept).min(window.x1));
            if first >= last {
                continue;
            }
            let at = (y - by) as usize * sums.stride + (x - bx) as usize;
            let zero = f32x8::splat(simd, 0.0);
            let mut sectors = [Sector::new([zero; 5], zero); N];
            for k in 0..N {
                let mut values = [zero; CHANNELS];
                for (channel, value) in values.iter_mut().enumerate() {
                    let start = (k * CHANNELS + channel) * plane + at;
                    *value = eight(simd, &sums.values, start);
                }
                sectors[k] = Sector::new(values, f32x8::splat(simd, totals[k]));
            }
            // The pixels left of the window are not held; whatever stands for them is not written.
            let mut pixels = [0.0; 32];
            let source = pass.inputs[0].offset(first, y);
            let (skip, len) = (4 * (first - x) as usize, 4 * (last - first) as usize);
            pixels[skip..skip + len].copy_from_slice(&pass.inputs[0].data()[source..source + len]);
            let original = read(simd, &pixels);
            let (colour, _) = response.of(&sectors, original);
            write(colour, &mut pixels);
            let target = 4 * (first - window.x0) as usize;
            band.row_mut(0, y)[target..target + len].copy_from_slice(&pixels[skip..skip + len]);
        }
    }
}
