//! Mode of the colours around each pixel that its own colour belongs to, by mean shift in colour (Comaniciu and Meer,
//! *Mean shift: a robust approach toward feature space analysis*, 2002; of local histograms Kass and Solomon 2010): the mean
//! of the colours around, weighed by their distance and by their difference to the mean so far. Two areas keep their
//! colours where most pixels have one or the other, and what lies between falls to the nearer; a slow change all over the
//! window has one mode, which is its mean. Transparent pixels count for nothing.
//!
//! Cost: about 22 operations per pixel of the window, a disc of about 3.1 radius^2, in each round; it is meant for a coarse
//! level, where windows are small.

pub use crate::kernels::shaders::local_mode::Params;
use crate::kernels::simd::line_buffer::{LineBuffer, STRIP, pixels, strips_of};
use crate::kernels::simd::pixels::{BLOCK, Block, eight};
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::math::Elementary;
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(local_mode {
    cpu: |simd, pass, params, band| run(simd, pass, &params, band),
    cost: |p| {
        let side = 2.0 * f64::from(p.radius) + 1.0;
        22.0 * 0.785 * side * side * f64::from(p.rounds)
    },
    tolerance: Tolerance {
        absolute: 2e-3,
        relative: 2e-5,
        outliers: 4e-3,
        reason: "roundings of the weights, which grow from round to round where a colour lies between two modes",
    },
});

/// Options of the pass.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Standard deviation of the window, pixels of the image.
    pub sigma: f32,
    /// Standard deviation of the weights in colour, in the unit of the colour.
    pub tolerance: f32,
    /// Rounds.
    pub rounds: i32,
}

/// End of the window, in standard deviations.
const CUTOFF: f32 = 2.2;
/// Windows end at this radius, whatever is asked for.
const MAX_RADIUS: f32 = 16.0;

/// The modes of a colour, usually CIELAB.
pub fn pass(plan: &mut PlanBuilder, color: ImageId, options: &Options) -> ImageId {
    let radius = (CUTOFF * options.sigma).ceil().min(MAX_RADIUS) as i32;
    let exponent = |sigma: f32| -0.5 * std::f32::consts::LOG2_E / (sigma * sigma).max(1e-9);
    let params = Params {
        radius,
        rounds: options.rounds,
        domain: exponent(options.sigma),
        range: exponent(options.tolerance),
    };
    plan.pass(&KERNEL, &[color], &params, Class::Colour, Support::Pixels(radius as u32))
}

/// The taps of a window that lie on one row.
struct Chord {
    dy: i32,
    half: i32,
    /// Exponents of the weights by distance.
    domain: Vec<f32>,
}

fn chords(params: &Params) -> Vec<Chord> {
    let radius = params.radius;
    let chord = |dy: i32| {
        let half = (0..=radius).rev().find(|dx| dx * dx + dy * dy <= radius * radius).unwrap_or(0);
        let domain = (-half..=half).map(|dx| params.domain * (dx * dx + dy * dy) as f32).collect();
        Chord { dy, half, domain }
    };
    (-radius..=radius).map(chord).collect()
}

#[inline(always)]
fn run<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, band: &mut Band<'_>) {
    let (window, view, radius) = (band.window, &pass.inputs[0], params.radius);
    let chords = chords(params);
    let mut rows = LineBuffer::default();
    for (x0, x1) in strips_of(STRIP, window.x0, window.x1) {
        rows.start(x0, x1, radius, 4);
        for y in window.y0 - radius..window.y0 + radius {
            rows.load(simd, view, y);
        }
        for y in window.y0..window.y1 {
            rows.load(simd, view, y + radius);
            for x in (x0..x1).step_by(BLOCK) {
                let at = (x - x0 + radius) as usize;
                let [r, g, b, alpha] = pixels(simd, &rows.channels(y), at);
                let mut mode = [r, g, b];
                for _ in 0..params.rounds {
                    mode = shifted(simd, &rows, &chords, params.range, [y, at as i32], mode);
                }
                let [r, g, b] = mode;
                Block::until(x1, x, y).write([r, g, b, alpha], band, 0);
            }
        }
    }
}

/// The means of eight pixels of row `y`, whose values begin `at` in the rows held, after one more round.
#[inline(always)]
fn shifted<S: Simd>(
    simd: S,
    rows: &LineBuffer,
    chords: &[Chord],
    range: f32,
    [y, at]: [i32; 2],
    [r, g, b]: [f32x8<S>; 3],
) -> [f32x8<S>; 3] {
    let zero = f32x8::splat(simd, 0.0);
    let (range, least) = (f32x8::splat(simd, range), f32x8::splat(simd, -125.0));
    let (mut sum_r, mut sum_g, mut sum_b, mut norm) = (zero, zero, zero, zero);
    for chord in chords {
        let from = (at - chord.half) as usize;
        let (y, len) = (y + chord.dy, 2 * chord.half as usize + 8);
        let reds = &rows.row(y, 0)[from..from + len];
        let greens = &rows.row(y, 1)[from..from + len];
        let blues = &rows.row(y, 2)[from..from + len];
        let alphas = &rows.row(y, 3)[from..from + len];
        let domain = &chord.domain[..len - 7];
        for k in 0..domain.len() {
            let dr = eight(simd, reds, k) - r;
            let dg = eight(simd, greens, k) - g;
            let db = eight(simd, blues, k) - b;
            let distance2 = db.mul_add(db, dg.mul_add(dg, dr * dr));
            let exponent = distance2.mul_add(range, f32x8::splat(simd, domain[k]));
            let weight = exponent.at_least(least).exp2_falling() * eight(simd, alphas, k);
            sum_r = weight.mul_add(dr, sum_r);
            sum_g = weight.mul_add(dg, sum_g);
            sum_b = weight.mul_add(db, sum_b);
            norm += weight;
        }
    }
    let seen = norm.simd_gt(f32x8::splat(simd, 1e-6));
    let inverse = seen.select(f32x8::splat(simd, 1.0) / norm, zero);
    [sum_r.mul_add(inverse, r), sum_g.mul_add(inverse, g), sum_b.mul_add(inverse, b)]
}
