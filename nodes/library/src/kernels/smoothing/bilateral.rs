//! The bilateral filter with an isotropic window (3.4), or one axis of its xy-separable form (§ 3.3);
//! the range is measured as Euclidean distance of the three colour channels. Taps count by their
//! coverage, and coverage itself passes.
//!
//! Cost: about 22 operations per pixel of the window, a disc of about 3.1 radius^2 or a line of
//! 2 radius + 1 pixels. Neighbours lie on rows, so the rows are kept channel by channel and a tap is
//! three loads of eight pixels; half of the operations are the exponential. The shader reads its windows
//! through workgroup memory, about radius^2 / 16 + radius / 2 + 1 loads a pixel.

pub use crate::kernels::shaders::bilateral::Params;
use crate::kernels::shared::coverage;
use crate::kernels::simd::line_buffer::{LineBuffer, pixels};
use crate::kernels::simd::pixels::{BLOCK, Block, eight};
use isophote_engine::fearless_simd::{Simd, dispatch, f32x8, i32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(bilateral {
    cpu: run,
    cost: |p| {
        let [x, y] = p.extent.map(|r| 2.0 * f64::from(r) + 1.0);
        22.0 * if x.min(y) > 1.0 { 0.785 * x * y } else { x * y } + 10.0
    },
    tolerance: Tolerance {
        absolute: 1e-4,
        relative: 1e-5,
        outliers: 0.001,
        reason: "means of up to 10,000 products in the same order; exponentials exact to 2e-7, their \
                 arguments magnify the last bits of large differences",
    },
});

/// Neighbours that a pass looks at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Window {
    /// All within the radius.
    Disc,
    /// Neighbours on the pixel's row.
    Row,
    /// Neighbours on the pixel's column.
    Column,
}

/// Options of a pass.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Standard deviation of the domain weight, pixels.
    pub sigma_d: f32,
    /// Standard deviation of the range weight, in the unit of the colour.
    pub sigma_r: f32,
    /// End of the window, in standard deviations.
    pub cutoff: f32,
}

/// Windows end at this radius, whatever is asked for.
const MAX_RADIUS: f32 = 60.0;

/// Filters a colour, usually CIELAB.
pub fn pass(plan: &mut PlanBuilder, color: ImageId, window: Window, options: &Options) -> ImageId {
    let radius = (options.cutoff * options.sigma_d).ceil().min(MAX_RADIUS) as i32;
    let exponent = |sigma: f32| -0.5 * std::f32::consts::LOG2_E / (sigma * sigma).max(1e-9);
    let params = Params {
        extent: match window {
            Window::Disc => [radius; 2],
            Window::Row => [radius, 0],
            Window::Column => [0, radius],
        },
        domain: exponent(options.sigma_d),
        range: exponent(options.sigma_r),
    };
    plan.pass(&KERNEL, &[color], &params, Class::Colour, Support::Pixels(radius as u32))
}

/// Columns of a strip: few enough for the rows of usual windows to stay in the first-level cache.
const STRIP: usize = 64;

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    if is_opaque(pass, band, params.extent[1]) {
        dispatch!(pass.level, simd => filtered::<_, true>(simd, pass, &params, band));
    } else {
        dispatch!(pass.level, simd => filtered::<_, false>(simd, pass, &params, band));
    }
}

/// True when all alphas that the band reads are 1; multiplying by them changes nothing then.
fn is_opaque(pass: &CpuPass<'_>, band: &Band<'_>, reach: i32) -> bool {
    let view = &pass.inputs[0];
    let window = view.window();
    let (first, last) =
        ((band.window.y0 - reach).max(window.y0), (band.window.y1 - 1 + reach).min(window.y1 - 1));
    let start = view.offset(window.x0, first);
    let end = view.offset(window.x0, last) + view.stride();
    coverage::is_opaque(&view.data()[start..end])
}

/// The taps of a window that lie on one row.
struct Chord {
    dy: i32,
    half: i32,
    /// Exponents of the domain weights.
    domain: Vec<f32>,
}

fn chords(params: &Params) -> Vec<Chord> {
    let [rx, ry] = params.extent;
    let radius = rx.max(ry);
    let chord = |dy: i32| {
        let half = (0..=rx).rev().find(|dx| dx * dx + dy * dy <= radius * radius).unwrap_or(0);
        let domain = (-half..=half).map(|dx| params.domain * (dx * dx + dy * dy) as f32).collect();
        Chord { dy, half, domain }
    };
    (-ry..=ry).map(chord).collect()
}

#[inline(always)]
fn filtered<S: Simd, const OPAQUE: bool>(simd: S, pass: &CpuPass<'_>, params: &Params, band: &mut Band<'_>) {
    let window = band.window;
    let view = &pass.inputs[0];
    let [rx, ry] = params.extent;
    let radius = rx.max(ry);
    let chords = chords(params);
    let mut rows = LineBuffer::default();
    for x0 in (window.x0..window.x1).step_by(STRIP) {
        let x1 = (x0 + STRIP as i32).min(window.x1);
        rows.start(x0, x1, radius, 4);
        for y in window.y0 - ry..window.y0 + ry {
            rows.load(simd, view, y);
        }
        for y in window.y0..window.y1 {
            rows.load(simd, view, y + ry);
            for x in (x0..x1).step_by(BLOCK) {
                let at = (x - x0 + radius) as usize;
                let values = filtered_block::<S, OPAQUE>(simd, &rows, &chords, params.range, y, at);
                Block::until(x1, x, y).write(values, band, 0);
            }
        }
    }
}

/// Eight pixels of row `y`, whose values begin `at` in the rows held.
#[inline(always)]
fn filtered_block<S: Simd, const OPAQUE: bool>(
    simd: S,
    rows: &LineBuffer,
    chords: &[Chord],
    range: f32,
    y: i32,
    at: usize,
) -> [f32x8<S>; 4] {
    let zero = f32x8::splat(simd, 0.0);
    let range = f32x8::splat(simd, range);
    let [r, g, b, alpha] = pixels(simd, &rows.channels(y), at);
    let (mut sum_r, mut sum_g, mut sum_b, mut norm) = (zero, zero, zero, zero);
    // Indices, since iterators over several rows at once are not compiled for wide vectors.
    for chord in chords {
        let from = at - chord.half as usize;
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
            let mut weight = exp2(distance2.mul_add(range, f32x8::splat(simd, domain[k])));
            if !OPAQUE {
                weight *= eight(simd, alphas, k);
            }
            sum_r = weight.mul_add(dr, sum_r);
            sum_g = weight.mul_add(dg, sum_g);
            sum_b = weight.mul_add(db, sum_b);
            norm += weight;
        }
    }
    let seen = norm.simd_gt(f32x8::splat(simd, 1e-6));
    let inverse = seen.select(f32x8::splat(simd, 1.0) / norm, zero);
    [sum_r.mul_add(inverse, r), sum_g.mul_add(inverse, g), sum_b.mul_add(inverse, b), alpha]
}

/// 2^x for x <= 0, relative error below 2e-7; the smallest numbers below -125.
///
/// Adding 1.5 2^23 rounds x to a whole number and leaves it in the lower bits, from where it is added
/// to the exponent of the polynomial.
#[inline(always)]
fn exp2<S: Simd>(x: f32x8<S>) -> f32x8<S> {
    let simd = x.simd;
    let c = |v: f32| f32x8::splat(simd, v);
    let x = x.at_least(c(-125.0));
    let shifted = x + c(12_582_912.0);
    let r = x - (shifted - c(12_582_912.0));
    let p = c(1.326_472_7e-3);
    let p = p.mul_add(r, c(9.671_513e-3));
    let p = p.mul_add(r, c(5.550_733_7e-2));
    let p = p.mul_add(r, c(2.402_224_2e-1));
    let p = p.mul_add(r, c(6.931_47e-1));
    let p = p.mul_add(r, c(1.0));
    let exponent: i32x8<S> = shifted.bitcast::<i32x8<S>>() << 23;
    (p.bitcast::<i32x8<S>>() + exponent).bitcast()
}

#[cfg(test)]
mod tests {
    use super::*;
    use isophote_engine::fearless_simd::Level;

    #[test]
    fn powers_of_two_are_exact_to_2e_7() {
        dispatch!(Level::new(), simd => {
            assert_eq!(exp2(f32x8::splat(simd, 0.0)).to_array(), [1.0; 8]);
            for i in 0..20_000 {
                let x = f32x8::from_fn(simd, |lane| -((i * 8 + lane) as f32) * 7.8e-4);
                let got = exp2(x);
                for lane in 0..8 {
                    let want = f64::from(x[lane]).exp2();
                    let error = (f64::from(got[lane]) / want - 1.0).abs();
                    assert!(error < 2e-7, "at {}: {} for {want}", x[lane], got[lane]);
                }
            }
            assert!(exp2(f32x8::splat(simd, -1e30)).to_array().iter().all(|v| (0.0..1e-37).contains(v)));
        });
    }

    #[test]
    fn a_disc_of_radius_four_has_the_49_pixels_of_a_round_window_of_nine() {
        let params = Params { extent: [4, 4], domain: -1.0, range: -1.0 };
        assert_eq!(chords(&params).iter().map(|c| c.domain.len()).sum::<usize>(), 49);
    }
}
