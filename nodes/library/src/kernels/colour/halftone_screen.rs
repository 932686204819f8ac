//! Prints plates through halftone screens on paper. What a pixel of the result shows is the mean of its ink under a filter
//! about a pixel wide, found from the shape of the dots, so that no screen beats with the pixels; the mean over a cell is
//! the share that the plate asks for. Inks and paper mix as linear light, as they do for an eye that is far away.
//!
//! Lines, rings and squares are filtered by a triangle two pixels wide along each axis of the screen: exactly, but for the
//! bend of rings. Dots compare the share with a spot function, the sum of two
//! cosines (`CosineDot` of PDF, ISO 32000-1, 10.5.3), whose values are replaced by their rank, so that a ramp of
//! them has a known mean; four places in a pixel are averaged.
//!
//! Cost: for one ink about 180 multiply-adds and three powers per pixel, 120 more where the paper has a texture; each
//! further ink takes about 150 for dots, 30 for lines and rings, 50 for squares.

use crate::declare::choice::Numbered;
pub use crate::kernels::shaders::halftone_screen::Params;
use crate::kernels::shared::colour::srgb_encode;
use crate::kernels::shared::halftone_dots::{Screen, dots, fold, turn};
use crate::kernels::shared::sampling::sample_linear4;
use crate::kernels::shared::value_noise::noise;
use crate::kernels::simd::pixels::{Block, for_blocks, write};
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance, View};

crate::kernel!(halftone_screen {
    cpu: |simd, pass, params, band| print(simd, pass, &params, band),
    cost: |p| {
        let shape = match p.shape {
            0 => 150.0,
            3 => 50.0,
            _ => 30.0,
        };
        70.0 + shape * f64::from(p.plates) + if p.texture_amount > 0.0 { 120.0 } else { 0.0 }
    },
    tolerance: Tolerance {
        absolute: 2e-4,
        relative: 1e-4,
        outliers: 1e-3,
        reason: "places on the screen are a few units in the last place apart, which the borders of dots magnify, and \
                 the sRGB curve magnifies thirteen times where ink is black",
    },
});

crate::declare::choice::choice! {
    /// Shape of what a screen prints.
    pub enum Shape {
        /// Round dots that grow until they meet as squares; from there on the paper between them shrinks to round holes.
        Dots = 0 ("dots", "Dots"),
        /// Straight lines along the angle that swell with the tone.
        Lines = 1 ("lines", "Lines"),
        /// Rings around one point that swell with the tone.
        Rings = 2 ("rings", "Rings"),
        /// Squares that grow until they meet.
        Squares = 3 ("squares", "Squares"),
    }
}

/// A plate; lengths in pixels of the picture that is rendered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plate {
    /// Angle of the screen, degrees counterclockwise.
    pub angle: f32,
    /// Place of the plate against that of the paper, x right and y down.
    pub moved: [f32; 2],
    /// Place in a cell where rings begin, 0..=1.
    pub phase: f32,
    /// Factors on the light of what lies below the ink, linear RGB, 0..=1.
    pub keep: [f32; 3],
    /// Light that the ink adds, linear RGB.
    pub add: [f32; 3],
}

/// Screens and sheet; lengths in pixels of the picture that is rendered.
#[derive(Clone, Copy, Debug)]
pub struct Print<'a> {
    /// Plates in the order of printing, 1..=4: the channels of what is printed.
    pub plates: &'a [Plate],
    /// Shape of what the screens print.
    pub shape: Shape,
    /// Distance of dots or lines; below 2 the screen fades to flat tones, which proxies then show.
    pub cell: f32,
    /// Softness of dots, 0..=1: at 1 all tones between paper and ink lie in every cell.
    pub softness: f32,
    /// Middle of rings in the canonical picture.
    pub centre: [f32; 2],
    /// Linear RGB of the paper.
    pub paper: [f32; 3],
    /// Strength of the paper's texture, 0..=1.
    pub texture: f32,
    /// Opaque also where the picture is not.
    pub cover: bool,
    /// Rendered size over full size.
    pub scale: f32,
    /// Position of the picture in the canonical one.
    pub origin: [f32; 2],
}

/// Slope of the sRGB curve against that of light, by which the texture of encoded paper is that of light.
const GAMMA: f32 = 2.2;

/// Prints `shares` of the paper ([`ink_separation`](super::ink_separation)) of a picture that `source` has the alpha of.
pub fn pass(plan: &mut PlanBuilder, shares: ImageId, source: ImageId, print: &Print<'_>) -> ImageId {
    let frequency = 1.0 / print.cell.max(0.5);
    let (mut screens, mut keeps, mut adds) = ([[0.0; 4]; 4], [[0.0; 4]; 4], [[0.0; 4]; 4]);
    for (index, plate) in print.plates.iter().take(4).enumerate() {
        let (sin, cos) = turn(plate.angle);
        let ([dx, dy], [kr, kg, kb], [ar, ag, ab]) = (plate.moved, plate.keep, plate.add);
        screens[index] = [cos * frequency, sin * frequency, dx, dy];
        keeps[index] = [kr, kg, kb, plate.phase];
        adds[index] = [ar, ag, ab, 0.0];
    }
    let [r, g, b] = print.paper;
    let params = Params {
        screens,
        keeps,
        adds,
        paper: [r, g, b, 1.0],
        origin: print.origin,
        centre: print.centre,
        frequency,
        border: frequency.max(0.5 * print.softness).min(0.5),
        blur: print.softness,
        shape: print.shape.number(),
        plates: print.plates.len().min(4) as u32,
        depth: (print.cell - 1.0).clamp(0.0, 1.0),
        texture_amount: GAMMA * print.texture,
        inverse_scale: 1.0 / print.scale,
        cover: print.cover.into(),
        padding: Default::default(),
    };
    plan.pass(&KERNEL, &[shares, source], &params, Class::Colour, Support::Pixels(reach(&params)))
}

/// The most pixels that a plate reads away.
fn reach(params: &Params) -> u32 {
    let farthest =
        params.screens.iter().flat_map(|screen| &screen[2..]).fold(0f32, |most, v| most.max(v.abs()));
    if farthest > 0.0 { farthest.ceil() as u32 + 1 } else { 0 }
}

#[inline(always)]
fn print<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, band: &mut Band<'_>) {
    let (shares, source) = (&pass.inputs[0], &pass.inputs[1]);
    let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
    for_blocks::<4>(
        band,
        #[inline(always)]
        |block, target| {
            let [cx, cy] = block.centres(simd);
            let (x, y) = (cx + params.origin[0], cy + params.origin[1]);
            let shade = shade(simd, params, [x, y]);
            let mut light = [shade * params.paper[0], shade * params.paper[1], shade * params.paper[2]];
            for plate in 0..params.plates.min(4) as usize {
                let [_, _, dx, dy] = params.screens[plate];
                let share = share(simd, shares, block, [dx, dy], plate).within(zero, one);
                let seen = covered(params, plate, [x - dx, y - dy], share).within(zero, one);
                let ink = share + (seen - share) * params.depth;
                for channel in 0..3 {
                    let change =
                        light[channel] * (params.keeps[plate][channel] - 1.0) + params.adds[plate][channel];
                    light[channel] += ink * change;
                }
            }
            let [r, g, b] = srgb_encode(light);
            let [.., alpha]: [f32x8<S>; 4] = block.read(simd, source);
            write([r, g, b, if params.cover != 0 { one } else { alpha }], target);
        },
    );
}

/// Factor of the paper's texture.
#[inline(always)]
fn shade<S: Simd>(simd: S, params: &Params, [x, y]: [f32x8<S>; 2]) -> f32x8<S> {
    if params.texture_amount <= 0.0 {
        return f32x8::splat(simd, 1.0);
    }
    let (x, y) = (x * params.inverse_scale, y * params.inverse_scale);
    let grain = noise(simd, x * 0.4, y * 0.4, 0) * 0.45
        + noise(simd, x * 0.13, y * 0.13, 1013) * 0.3
        + noise(simd, x * 0.037, y * 0.037, 2027) * 0.25;
    (grain - 0.5) * params.texture_amount + 1.0
}

/// The share that a plate asks for, which lies (dx, dy) from where it is printed.
#[inline(always)]
fn share<S: Simd>(simd: S, shares: &View<'_>, block: Block, [dx, dy]: [f32; 2], plate: usize) -> f32x8<S> {
    if dx == 0.0 && dy == 0.0 {
        let pixels: [f32x8<S>; 4] = block.read(simd, shares);
        return pixels[plate];
    }
    let [cx, cy] = block.centres(simd);
    sample_linear4(simd, shares, cx - dx, cy - dy)[plate]
}

/// The paper that a plate covers at a position in the canonical picture.
#[inline(always)]
fn covered<S: Simd>(params: &Params, plate: usize, [x, y]: [f32x8<S>; 2], share: f32x8<S>) -> f32x8<S> {
    let [cos, sin, ..] = params.screens[plate];
    if params.shape == Shape::Rings as u32 {
        let (x, y) = (x - params.centre[0], y - params.centre[1]);
        let radius = (x * x + y * y).sqrt();
        return stripe(params, fold(radius * params.frequency + params.keeps[plate][3]), share);
    }
    let (u, v) = (x * cos - y * sin, x * sin + y * cos);
    if params.shape == Shape::Dots as u32 {
        return dots(
            Screen { turned: [cos, sin], frequency: params.frequency, blur: params.blur },
            [u, v],
            share,
        );
    }
    let (a, b) = (fold(u), fold(v));
    if params.shape == Shape::Lines as u32 {
        return stripe(params, b, share);
    }
    let side = share.sqrt();
    stripe(params, a, side) * stripe(params, b, side)
}

/// Share of a triangle of -1..=1 that lies below x.
#[inline(always)]
fn ramp<S: Simd>(x: f32x8<S>) -> f32x8<S> {
    let t = x.within(-1.0, 1.0);
    t - t * t.abs() * 0.5 + 0.5
}

/// Stripes that cover `share` of every cell, `a` from the middle of one, under a triangle `params.border` to each side:
/// its own borders and that of the next stripe.
#[inline(always)]
fn stripe<S: Simd>(params: &Params, a: f32x8<S>, share: f32x8<S>) -> f32x8<S> {
    let h = 1.0 / params.border;
    let half = share * 0.5;
    ramp((half - a) * h) - ramp((-half - a) * h) + ramp((a - 1.0 + half) * h)
}
