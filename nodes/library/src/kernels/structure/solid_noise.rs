//! Noise that belongs to the surfaces of objects: smooth solid noise at the points of the undeformed objects, of the two
//! octaves whose marks on screen are just smaller and just larger than is asked for. Where there is no object, the noise
//! of the screen stays.
//!
//! An octave is white noise on a cubic lattice, smoothed by the quadratic B-spline, which is nearly a Gaussian of half
//! the lattice's spacing. A plane through it has the autocorrelation exp(-d^2 / (4 sigma^2)) of white noise of the screen
//! that a Gaussian has smoothed, and about the same distribution: styles look the same by either. Octaves are spaced by
//! powers of two in the objects' units, and their shares depend on how much of the object a pixel covers, so that marks
//! keep their size on screen within a tenth; the sum is divided by its standard deviation, so that nothing pulsates
//! (after Bénard, Bousseau and Thollot, Dynamic solid textures, 2009).
//!
//! Cost: three loads, 54 hashes and about 350 multiply-adds.

pub use crate::kernels::shaders::solid_noise::Params;
use crate::kernels::shared::rest_position::{has_footprint, is_at_rest};
use crate::kernels::simd::pixels::{Block, for_blocks, write};
use crate::kernels::simd::window_sum::{gaussian_radius, gaussian_table};
use isophote_engine::dispatch::at_most_avx2;
use isophote_engine::fearless_simd::{Simd, dispatch, f32x8, i32x8, prelude::*, u32x8};
use isophote_engine::math::{self, Elementary};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};
use std::f32::consts::LOG2_E;

crate::kernel!(solid_noise {
    cpu: run,
    cost: |_| 1100.0,
    tolerance: Tolerance {
        absolute: 2e-4,
        relative: 0.0,
        outliers: 1e-3,
        reason: "shares of octaves by roots of a logarithm's last bits; cells are exact",
    },
});

/// Appearance of noise on screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Marks {
    /// Standard deviation of the Gaussian that noise of the screen is smoothed by to have marks of this size, pixels of
    /// the rendered picture.
    pub sigma: f32,
    /// Standard deviation of the noise's values about 0.5.
    pub deviation: f32,
    /// Another number gives another noise.
    pub seed: u32,
}

impl Marks {
    /// Moments of white noise, uniform in 0..=1, that a Gaussian of `sigma` pixels of the rendered picture has smoothed, which
    /// is rendered at `scale` of its full size.
    pub fn of_smoothed_noise(sigma: f32, scale: f32, seed: u32) -> Self {
        // Proxies show the full picture made smaller: its contrast is that at full size.
        let full = sigma / scale;
        let radius = gaussian_radius(full, 3.0);
        let table = gaussian_table(full, radius);
        let weights = table.as_flattened();
        let squares = weights[0].powi(2) + 2.0 * weights[1..].iter().map(|w| w * w).sum::<f32>();
        Self { sigma, deviation: squares / 12f32.sqrt(), seed }
    }
}

/// Weight of the coarse octave's variance against the fine one's, the root of 1/2: lines along which marks are smoothed
/// keep more of it, in proportion to its width. Widths of marks then vary by a tenth at most, smoothed along lines or not.
const COARSE: f32 = 0.7071;

/// Standard deviation of a pixel's square on either axis, pixels: grains of the screen are not smaller.
const PIXEL: f32 = 0.289;

/// Least standard deviation of marks that pixels can show without flicker, pixels.
const LEAST: f32 = 0.5;

/// Adds the pass: noise at `points` whose pixels have `scales` ([`rest_scale`](super::rest_scale)), and elsewhere the
/// noise `screen`; grey and opaque.
pub fn pass(
    plan: &mut PlanBuilder,
    points: ImageId,
    scales: ImageId,
    screen: ImageId,
    marks: &Marks,
) -> ImageId {
    let sigma = math::hypot(marks.sigma, PIXEL).max(LEAST);
    let params = Params { spacing: (2.0 * sigma).log2(), deviation: marks.deviation, seed: marks.seed };
    plan.pass(&KERNEL, &[points, scales, screen], &params, Class::Colour, Support::Pixels(0))
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    dispatch!(at_most_avx2(pass.level), simd => for_blocks::<4>(band, #[inline(always)] |block, target| {
        write(marked(simd, pass, &params, block), target);
    }));
}

#[inline(always)]
fn marked<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, block: Block) -> [f32x8<S>; 4] {
    let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
    let point: [f32x8<S>; 4] = block.read(simd, &pass.inputs[0]);
    let [scale]: [f32x8<S>; 1] = block.read(simd, &pass.inputs[1]);
    let screen: [f32x8<S>; 4] = block.read(simd, &pass.inputs[2]);
    let counts = is_at_rest(point) & has_footprint(scale);
    if !counts.any_true() {
        return screen;
    }
    let mut p = [zero; 3];
    for c in 0..3 {
        p[c] = counts.select(point[c], zero);
    }
    // So far from 0 that floats do not tell finer cells apart, marks are larger.
    let farthest = p[0].abs().at_least(p[1].abs()).at_least(p[2].abs().at_least(1e-20));
    let level = (counts.select(scale, zero) + params.spacing).at_least(farthest.ln() * LOG2_E - 22.0);
    let level = level.within(-60.0, 60.0);
    let floor = level.floor();
    let octave: i32x8<S> = floor.to_int();
    // Where the shares of the variance go evenly from one octave to the next, the width of marks stays.
    let (fine, coarse) = ((one - (level - floor)).sqrt(), ((level - floor) * COARSE).sqrt());
    let sum = fine * noise(simd, p, octave, params.seed) + coarse * noise(simd, p, octave + 1, params.seed);
    let even = sum / (fine * fine + coarse * coarse).sqrt();
    let value = (even * params.deviation + 0.5).within(zero, one);
    let mut pixels = [one; 4];
    for c in 0..3 {
        pixels[c] = counts.select(value, screen[c]);
    }
    pixels[3] = counts.select(one, screen[3]);
    pixels
}

/// Solid noise of variance 1 whose values are 2^octave apart.
#[inline(always)]
fn noise<S: Simd>(simd: S, p: [f32x8<S>; 3], octave: i32x8<S>, seed: u32) -> f32x8<S> {
    const FACTORS: [u32; 3] = [0x9e37_79b1, 0x85eb_ca77, 0xc2b2_ae3d];
    // Products with a power of two are exact, and so are the whole part and the rest.
    let unit: f32x8<S> = ((i32x8::splat(simd, 127) - octave) << 23).bitcast();
    let seed = u32x8::splat(simd, seed) + octave.bitcast::<u32x8<S>>() * u32x8::splat(simd, 0x9e37_79b9);
    let mut hashes = [[seed; 3]; 3];
    let mut weights = [[unit; 3]; 3];
    let mut squares = f32x8::splat(simd, 1.0 / 12.0);
    for c in 0..3 {
        let q = p[c] * unit;
        let cell = q.floor();
        weights[c] = spline(q - cell);
        let [a, b, d] = weights[c];
        squares *= a * a + b * b + d * d;
        let middle: i32x8<S> = cell.to_int();
        let factor = u32x8::splat(simd, FACTORS[c]);
        for n in 0..3 {
            hashes[c][n] = (middle + (n as i32 - 1)).bitcast::<u32x8<S>>() * factor;
        }
    }
    let mut sum = f32x8::splat(simd, 0.0);
    for z in 0..3 {
        for y in 0..3 {
            let rest = hashes[1][y] ^ (hashes[2][z] ^ seed);
            let mut row = f32x8::splat(simd, 0.0);
            for x in 0..3 {
                row = hash(hashes[0][x] ^ rest).mul_add(weights[0][x], row);
            }
            sum = row.mul_add(weights[2][z] * weights[1][y], sum);
        }
    }
    // Sums of independent values vary as the squares of their weights: as much everywhere.
    sum / squares.sqrt()
}

/// Weights of the three cells around a place in the middle one: the quadratic B-spline.
#[inline(always)]
fn spline<S: Simd>(f: f32x8<S>) -> [f32x8<S>; 3] {
    let (g, h) = (f32x8::splat(f.simd, 1.0) - f, f - 0.5);
    [g * g * 0.5, f32x8::splat(f.simd, 0.75) - h * h, f * f * 0.5]
}

/// A number in -0.5..0.5 that belongs to a cell, of a sum of its coordinates' products.
#[inline(always)]
fn hash<S: Simd>(h: u32x8<S>) -> f32x8<S> {
    let (c, d) = (u32x8::splat(h.simd, 0x2c1b_3c6d), u32x8::splat(h.simd, 0x297a_2d39));
    let h = (h ^ (h >> 15)) * c;
    let h = (h ^ (h >> 12)) * d;
    let h = h ^ (h >> 15);
    let kept: i32x8<S> = (h >> 8).bitcast();
    kept.to_float::<f32x8<S>>() * 5.960_464_5e-8 - 0.5
}
