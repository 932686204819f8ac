//! Prints colours as dots of one ink on white paper or, where they are darker, on a tint of the same ink, as comics were
//! printed (§ 1.2); darks and pure colours are solid. Inks mix as linear light, and their mean is the colour.
//!
//! Of a colour, the ink is the darkest of its hue that has no channel below 0 and is not nearly black. Dots of it on white
//! grow with the colour until they cover 0.36 of the paper; from there on the paper between them takes a tint, so that flat
//! areas have dots of few sizes, which stay round, and fade as the tint becomes the ink. Colours brighter than paper stay.
//!
//! Cost: about 110 multiply-adds and seven powers per pixel.

pub use crate::kernels::shaders::benday_dots::Params;
use crate::kernels::shared::colour::{LUMINANCE, srgb_decode, srgb_encode};
use crate::kernels::shared::halftone_dots::{Screen, discs, turn};
use crate::kernels::shared::mark_tones::rise;
use crate::kernels::simd::pixels::Block;
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(benday_dots {
    block: |simd, pass, params| |block| printed(simd, pass, &params, block),
    cost: |_| 210.0,
    tolerance: Tolerance {
        absolute: 2e-4,
        relative: 1e-4,
        outliers: 1e-3,
        reason: "places on the screen are a few units in the last place apart, which the borders of dots magnify, and \
                 the sRGB curve magnifies thirteen times where ink is black",
    },
});

/// Dots and where they lie; lengths in pixels of the picture that is rendered.
#[derive(Clone, Copy, Debug)]
pub struct Dots {
    /// Distance of dots; below 2 they fade to flat tones, which proxies then show.
    pub spacing: f32,
    /// How much of the colours is printed, 0..=1.
    pub amount: f32,
    /// Opacity of the lines of the picture, which are not printed.
    pub opacity: f32,
    /// Position of the picture in the canonical one.
    pub origin: [f32; 2],
}

/// Angle of the screen, degrees.
const ANGLE: f32 = 45.0;

/// Prints a picture whose lines are where `edges` is 0.
pub fn pass(plan: &mut PlanBuilder, source: ImageId, edges: ImageId, dots: &Dots) -> ImageId {
    let frequency = 1.0 / dots.spacing.max(0.5);
    let (sin, cos) = turn(ANGLE);
    let params = Params {
        screen: [cos * frequency, sin * frequency],
        origin: dots.origin,
        frequency,
        depth: (dots.spacing - 1.0).clamp(0.0, 1.0),
        amount: dots.amount,
        opacity: dots.opacity,
    };
    plan.pass(&KERNEL, &[source, edges], &params, Class::Colour, Support::Pixels(0))
}

/// Share of the paper that the largest dots cover; luminance of the darkest ink; the share of ink from which on dots close;
/// and those below which paper is bare, and from which on it is not. Chosen by eye: dots that cover more look like a grid
/// of paper, and darker inks make greys harsh.
const LARGEST: f32 = 0.36;
const DARKEST_INK: f32 = 0.2;
const CLOSING: f32 = 0.8;
const BARE: f32 = 0.02;
const INKED: f32 = 0.08;

#[inline(always)]
fn printed<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, block: Block) -> [f32x8<S>; 4] {
    let [r, g, b, alpha]: [f32x8<S>; 4] = block.read(simd, &pass.inputs[0]);
    let [edge]: [f32x8<S>; 1] = block.read(simd, &pass.inputs[1]);
    let one = f32x8::splat(simd, 1.0);
    let light = srgb_decode([r, g, b]);
    // What is brighter than paper shines through it.
    let paper = [light[0].at_least(one), light[1].at_least(one), light[2].at_least(one)];
    let taken = [paper[0] - light[0], paper[1] - light[1], paper[2] - light[2]];
    // The share that the darkest ink of this hue would cover: one whose least channel is 0, if that is light enough.
    let strongest = taken[0].at_least(taken[1]).at_least(taken[2]);
    let luminance = taken[0] * LUMINANCE[0] + taken[1] * LUMINANCE[1] + taken[2] * LUMINANCE[2];
    let solid = strongest.at_least(luminance * (1.0 / (1.0 - DARKEST_INK))).within(1e-4, 1.0);
    let growing = solid - solid * solid * (0.25 / LARGEST);
    let share = solid.simd_lt(2.0 * LARGEST).select(growing, one * LARGEST);
    let [cx, cy] = block.centres(simd);
    let (x, y) = (cx + params.origin[0], cy + params.origin[1]);
    let [cos, sin] = params.screen;
    let screen = Screen { turned: params.screen, frequency: params.frequency, blur: 0.0 };
    let seen = discs(screen, [x * cos - y * sin, x * sin + y * cos], share).within(0.0, 1.0);
    let open = one - rise((solid - CLOSING) * (1.0 / (1.0 - CLOSING)));
    let contrast = (one / solid - one) / (one - share) * open * params.depth;
    let ink = (one + contrast * (seen - share)) * rise((solid - BARE) * (1.0 / (INKED - BARE)));
    let amount = (one - (one - edge.within(0.0, 1.0)) * params.opacity) * params.amount;
    let factor = one + amount * (ink - one);
    let [r, g, b] = srgb_encode([
        paper[0] - taken[0] * factor,
        paper[1] - taken[1] * factor,
        paper[2] - taken[2] * factor,
    ]);
    [r, g, b, alpha]
}
