//! Separates a picture into printing plates: the share of the paper that each ink covers. Shares are of light: what they
//! print has, seen from afar, the picture's own light against that of the paper (Neugebauer 1937).
//!
//! Three inks are fitted by least squares, one after the other in a few rounds, to what the others leave: inks cover each
//! other by chance, so that their mean colours multiply (Demichel). Where black has a plate, it prints a share of the
//! common grey first (grey-component replacement).
//!
//! Cost: about 20 multiply-adds per pixel for one ink, 400 for three and black.

pub use crate::kernels::shaders::ink_separation::Params;
use crate::kernels::shared::colour::{LUMINANCE, Rgb, lab_curve_inverse, lab_to_linear};
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Class, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(ink_separation {
    block: |simd, pass, params| |block| separated(block.read(simd, &pass.inputs[0]), &params),
    cost: |p| if p.plates == 1 { 25.0 } else { 450.0 },
    tolerance: Tolerance {
        absolute: 1e-3,
        relative: 1e-4,
        outliers: 1e-2,
        reason: "shares are quotients of differences, which faint light divides by little; a channel that cancels among \
                 others far above white keeps no digit",
    },
    fast: Tolerance {
        absolute: 5e-3,
        relative: 2e-3,
        outliers: 2e-3,
        reason: "L of eleven bits is up to 0.03 off, whose light inks share by quotients of small differences",
    },
});

/// Plates that a picture is separated into, by the light that inks take from the paper, linear RGB, 0..=1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Plates {
    /// One ink for lightness: it prints the darks, or the lights where the paper is darker than it.
    One {
        /// The ink prints the lights.
        lights: bool,
    },
    /// Three inks.
    Three([[f32; 3]; 3]),
    /// Three inks and black.
    Four {
        /// The three.
        inks: [[f32; 3]; 3],
        /// Light that black takes from the paper.
        black: f32,
        /// Share of the common grey that black prints, 0..=1.
        replaced: f32,
    },
}

/// Weight of differences of luminance beside those of the channels, and the least length of an ink's light, squared, at
/// which it counts in full.
const LIGHT: f32 = 3.0;
const FAINT: f32 = 2e-3;
/// Rounds of the fit: the colours that further ones print are hardly others.
const ROUNDS: usize = 4;

/// Separates a Lab image, its colour axes times `chroma`, into shares of 0..=1 in the first channels, times its alpha.
pub fn pass(plan: &mut PlanBuilder, lab: ImageId, plates: Plates, chroma: f32) -> ImageId {
    let none = [[0.0; 3]; 3];
    let (count, inks, black, replaced, lights) = match plates {
        Plates::One { lights } => (1, none, 0.0, 0.0, lights),
        Plates::Three(inks) => (3, inks, 0.0, 0.0, false),
        Plates::Four { inks, black, replaced } => (4, inks, black, replaced, false),
    };
    let params = Params {
        inks: inks.map(|[r, g, b]| [r, g, b, 0.0].map(|v: f32| v.clamp(0.0, 1.0))),
        chroma,
        plates: count,
        replaced,
        // Some light is left, to divide by.
        black: black.clamp(0.0, 0.999),
        lights: lights.into(),
        padding: Default::default(),
    };
    plan.pass(&KERNEL, &[lab], &params, Class::Colour, Support::Pixels(0))
}

#[inline(always)]
fn separated<S: Simd>([l, a, b, alpha]: [f32x8<S>; 4], params: &Params) -> [f32x8<S>; 4] {
    let simd = l.simd;
    let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
    let alpha = alpha.within(zero, one);
    if params.plates == 1 {
        let light = lab_curve_inverse((l + 16.0) * (1.0 / 116.0)).within(zero, one);
        let share = if params.lights != 0 { light } else { one - light };
        return [share * alpha, zero, zero, zero];
    }
    let [r, g, b] = lab_to_linear([l, a * params.chroma, b * params.chroma]);
    let mut wanted = [r.within(zero, one), g.within(zero, one), b.within(zero, one)];
    let mut black = zero;
    if params.plates == 4 {
        let [r, g, b] = wanted;
        black = (one - r.at_least(g).at_least(b)) * params.replaced;
        let left = one / (one - black * params.black);
        wanted = [(r * left).at_most(one), (g * left).at_most(one), (b * left).at_most(one)];
    }
    let inks = [taken(simd, params, 0), taken(simd, params, 1), taken(simd, params, 2)];
    let mut s = [zero; 3];
    for _ in 0..ROUNDS {
        s[0] = share(left([s[1], s[2]], [inks[1], inks[2]]), wanted, inks[0]);
        s[1] = share(left([s[0], s[2]], [inks[0], inks[2]]), wanted, inks[1]);
        s[2] = share(left([s[0], s[1]], [inks[0], inks[1]]), wanted, inks[2]);
    }
    [s[0] * alpha, s[1] * alpha, s[2] * alpha, black * alpha]
}

/// Light that an ink takes.
#[inline(always)]
fn taken<S: Simd>(simd: S, params: &Params, ink: usize) -> Rgb<S> {
    let [r, g, b, _] = params.inks[ink];
    [f32x8::splat(simd, r), f32x8::splat(simd, g), f32x8::splat(simd, b)]
}

/// Light that two inks leave.
#[inline(always)]
fn left<S: Simd>([s, t]: [f32x8<S>; 2], [a, b]: [Rgb<S>; 2]) -> Rgb<S> {
    let one = f32x8::splat(s.simd, 1.0);
    let mut light = [one; 3];
    for channel in 0..3 {
        light[channel] = (one - s * a[channel]) * (one - t * b[channel]);
    }
    light
}

/// The share of an ink that takes `taken` of what the others leave, nearest to `wanted`.
#[inline(always)]
fn share<S: Simd>(left: Rgb<S>, wanted: Rgb<S>, taken: Rgb<S>) -> f32x8<S> {
    let change = [left[0] * taken[0], left[1] * taken[1], left[2] * taken[2]];
    let excess = [left[0] - wanted[0], left[1] - wanted[1], left[2] - wanted[2]];
    (agreement(excess, change) / (agreement(change, change) + FAINT)).within(0.0, 1.0)
}

/// Product of two differences of colour.
#[inline(always)]
fn agreement<S: Simd>(a: Rgb<S>, b: Rgb<S>) -> f32x8<S> {
    dot(a, b) + luminance(a) * luminance(b) * LIGHT
}

#[inline(always)]
fn dot<S: Simd>(a: Rgb<S>, b: Rgb<S>) -> f32x8<S> {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn luminance<S: Simd>([r, g, b]: Rgb<S>) -> f32x8<S> {
    r * LUMINANCE[0] + g * LUMINANCE[1] + b * LUMINANCE[2]
}
