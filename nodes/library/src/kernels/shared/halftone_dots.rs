//! Round dots of a halftone screen; the twin of `shaders/shared/halftone_dots.wgsl`.

use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};

/// Width of the borders of dots, pixels; the least size of a dot's blur, square pixels; the steepest rise of the spot
/// function, per cell; and one of four places in a pixel, which the others turn to. Chosen together by the greatest
/// error of a flat tone below a third of the screen's frequency.
const EDGE: f32 = 0.9;
const LEAST_DOT: f32 = 4.65;
const STEEPEST: f32 = 2.2;
const PLACE: [f32; 2] = [0.335, 0.236];

/// Screen of round dots.
#[derive(Clone, Copy, Debug)]
pub struct Screen {
    /// Cosine and sine of its angle over the size of a cell.
    pub turned: [f32; 2],
    /// 1 / size of a cell, 1/pixel.
    pub frequency: f32,
    /// Least width of the borders of dots, in shares of the paper.
    pub blur: f32,
}

/// Sine and cosine of an angle in degrees, exact for right angles.
pub fn turn(degrees: f32) -> (f32, f32) {
    let (sin, cos) = f64::from(degrees).rem_euclid(360.0).to_radians().sin_cos();
    let exact = |v: f64| if v.abs() < 1e-12 { 0.0 } else { v as f32 };
    (exact(sin), exact(cos))
}

/// Distance of x from the nearest whole number, 0..=1/2.
#[inline(always)]
pub fn fold<S: Simd>(x: f32x8<S>) -> f32x8<S> {
    (x - (x + 0.5).floor()).abs()
}

/// cos(2 pi a) for a in 0..=1/2.
#[inline(always)]
fn wave<S: Simd>(a: f32x8<S>) -> f32x8<S> {
    let t = a * -4.0 + 1.0;
    let q = t * t;
    t * (q * (q * 0.072_710_2 - 0.643_229_2) + 1.570_626_8)
}

/// The share of a cell where the sum of two cosines is greater than at (u, v): a fit by least squares, off by 0.0008.
#[inline(always)]
fn threshold<S: Simd>(u: f32x8<S>, v: f32x8<S>) -> f32x8<S> {
    let s = (wave(fold(u)) + wave(fold(v))) * 0.5;
    let r = s.abs().sqrt();
    let g =
        r * (r * (r * (r * (r * -0.217_891_2 + 0.786_319_34) - 1.244_632_74) + 1.132_112_94) + 0.043_885_41);
    g.copysign(s) * -1.0 + 0.5
}

/// Border of dots or holes, in thresholds: its middle, and 1 over its width.
#[derive(Clone, Copy, Debug)]
struct Border<S: Simd> {
    middle: f32x8<S>,
    inverse: f32x8<S>,
}

impl<S: Simd> Border<S> {
    /// That of dots of area `m`.
    ///
    /// Thresholds are even in 0..=1, so that a ramp of them has a mean that is known, which is what moves it where it would
    /// leave the range.
    #[inline(always)]
    fn of(screen: Screen, m: f32x8<S>) -> Self {
        // The circumference of a dot of area m is 2 sqrt(pi m).
        let rise = (m.sqrt() * 3.544_907_7).at_most(STEEPEST) * (EDGE * screen.frequency);
        let size = LEAST_DOT * screen.frequency * screen.frequency;
        let least = f32x8::splat(m.simd, 0.5 * size * size) / m.at_least(1e-5);
        let w = rise.at_least(screen.blur).at_least(least);
        let extent = (w * m * 2.0).sqrt();
        let low = extent.simd_le(1.0).select(extent - w * 0.5, w * (m - 0.5) + 0.5);
        Self { middle: m.simd_lt(w * 0.5).select(low, m), inverse: f32x8::splat(m.simd, 1.0) / w }
    }

    /// Share of ink where the threshold is `t`.
    #[inline(always)]
    fn within(self, t: f32x8<S>) -> f32x8<S> {
        ((self.middle - t) * self.inverse + 0.5).within(0.0, 1.0)
    }
}

/// Four places in a pixel, in cells.
#[inline(always)]
fn places(screen: Screen) -> [[f32; 2]; 4] {
    let ([cos, sin], [px, py]) = (screen.turned, PLACE);
    let [px, py] = [px * cos - py * sin, px * sin + py * cos];
    [[px, py], [-py, px], [-px, -py], [py, -px]]
}

/// Dots that cover `share` of every cell, at a place in cells, and meet as squares at a half; above it round holes.
#[inline(always)]
pub fn dots<S: Simd>(screen: Screen, [u, v]: [f32x8<S>; 2], share: f32x8<S>) -> f32x8<S> {
    let (zero, one) = (f32x8::splat(share.simd, 0.0), f32x8::splat(share.simd, 1.0));
    let dark = share.simd_gt(0.5);
    let border = Border::of(screen, dark.select(one - share, share));
    let mut sum = zero;
    for [du, dv] in places(screen) {
        let t = threshold(u + du, v + dv);
        sum += border.within(dark.select(one - t, t));
    }
    let mean = sum * 0.25;
    dark.select(one - mean, mean)
}

/// Dots that are discs up to a share of about 0.4: farther out discs of neighbours meet.
#[inline(always)]
pub fn discs<S: Simd>(screen: Screen, [u, v]: [f32x8<S>; 2], share: f32x8<S>) -> f32x8<S> {
    let border = Border::of(screen, share);
    let mut sum = f32x8::splat(share.simd, 0.0);
    for [du, dv] in places(screen) {
        let (a, b) = (fold(u + du), fold(v + dv));
        sum += border.within((a * a + b * b) * std::f32::consts::PI);
    }
    sum * 0.25
}
