//! Lays ink, graphite, charcoal or chalk on paper (§ 4.3, 4.4): lines, and the marks of tones, both of which catch on the
//! paper's grain. Cells of grain are those of the full-size picture, so that tiles and proxies show the same sheet; a
//! paper may be given, too.
//!
//! Cost: 12 hashes and about 120 multiply-adds per pixel.

pub use crate::kernels::shaders::ink_sheet::Params;
use crate::kernels::shared::coverage::LEAST_COVERAGE;
use crate::kernels::shared::mark_tones::{INVERSE_FADE, SMOOTH_FROM, rise, tone_lightness};
use crate::kernels::shared::value_noise::noise;
use crate::kernels::simd::pixels::{for_blocks, write};
use isophote_engine::dispatch::at_most_avx2;
use isophote_engine::fearless_simd::{Simd, dispatch, f32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(ink_sheet {
    cpu: run,
    cost: |_| 260.0,
    tolerance: Tolerance {
        absolute: 1e-4,
        relative: 1e-4,
        outliers: 1e-3,
        reason: "cells are placed by products exact to a few units in the last place",
    },
});

/// Sheet of paper, and how the drawing is laid on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sheet {
    /// RGB and opacity of the ink.
    pub line: [f32; 4],
    /// RGB of the paper; its alpha is not used.
    pub paper: [f32; 4],
    /// Depth of the paper's grain, 0..=2.
    pub grain: f32,
    /// Size of the grains, pixels of the full-size picture.
    pub grain_size: f32,
    /// Rendered size over full size.
    pub scale: f32,
    /// Share of the picture's own colours that shows, 0..=1.
    pub colour: f32,
    /// Share of the paper that they cover before anything is drawn, 0..=1.
    pub ground: f32,
    /// Strength of the paper's texture, 0..=1.
    pub texture: f32,
    /// Share of the grain that follows the strokes instead of the paper, 0..=1.
    pub follow: f32,
    /// Degree to which solid ink, too, breaks on the grain, 0..=1.
    pub dryness: f32,
    /// Lines are cut out of marks where the second channel of the lines says so.
    pub cut: bool,
    /// Opaque also where the picture is not.
    pub cover: bool,
    /// What is drawn alone, without the paper.
    pub bare: bool,
    /// Position of the picture in the canonical one, pixels.
    pub origin: [f32; 2],
}

/// Drawing on the sheet.
#[derive(Clone, Copy, Debug)]
pub struct Drawing {
    /// Black lines on white; in the second channel those that are cut out of marks. Where lines are `painted`, those of
    /// [`ink_paint`](super::ink_paint).
    pub lines: ImageId,
    /// Lines have a colour at each pixel.
    pub painted: bool,
    /// The picture, whose own colours may show.
    pub color: ImageId,
    /// Noise along the form, 0..=1, in the first channel.
    pub strokes: ImageId,
    /// Share of the paper that marks cover ([`tone_marks`](super::tone_marks)).
    pub marks: ImageId,
    /// Tones of the picture, (L alpha, alpha): light ones show no grain.
    pub tones: ImageId,
    /// Colours of a paper, and the depth of its grain ([`paper_relief`](super::paper_relief)).
    pub paper: Option<ImageId>,
}

/// Share of the paper that chalk covers, and the part of their lightness that its colours keep in lines above it.
const COVERED: f32 = 0.85;
const DARKEST: f32 = 0.3;

/// Draws on a sheet.
pub fn pass(plan: &mut PlanBuilder, drawing: &Drawing, sheet: &Sheet) -> ImageId {
    let params = Params {
        line: sheet.line,
        paper: sheet.paper,
        grain: sheet.grain.clamp(0.0, 2.0),
        grain_frequency: 1.0 / sheet.grain_size.max(0.1),
        inverse_scale: 1.0 / sheet.scale,
        colour: sheet.colour.clamp(0.0, 1.0),
        ground: sheet.ground,
        tint: DARKEST + (1.0 - DARKEST) * (1.0 - sheet.ground / COVERED).clamp(0.0, 1.0),
        texture_amount: sheet.texture,
        cover: sheet.cover.into(),
        bare: sheet.bare.into(),
        follow: sheet.follow,
        dryness: sheet.dryness,
        cut: f32::from(sheet.cut),
        smooth_from: SMOOTH_FROM,
        inverse_fade: INVERSE_FADE,
        given: drawing.paper.is_some().into(),
        painted: drawing.painted.into(),
        origin: sheet.origin,
        padding: Default::default(),
    };
    let paper = drawing.paper.unwrap_or(drawing.color);
    let inputs = [drawing.lines, drawing.color, drawing.strokes, drawing.marks, drawing.tones, paper];
    plan.pass(&KERNEL, &inputs, &params, Class::Colour, Support::Pixels(0))
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    // By AVX-512 it takes a third longer.
    dispatch!(at_most_avx2(pass.level), simd => sheet(simd, pass, &params, band));
}

#[inline(always)]
fn sheet<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, band: &mut Band<'_>) {
    let [lines, source, strokes, marks, tones, given] = pass.inputs else { return };
    let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
    for_blocks::<4>(
        band,
        #[inline(always)]
        |block, target| {
            let columns: f32x8<S> = block.columns(simd).to_float();
            let x = (columns + 0.5 + params.origin[0]) * params.inverse_scale;
            let y = f32x8::splat(simd, (block.y as f32 + 0.5 + params.origin[1]) * params.inverse_scale);
            let (paper, tooth) = if params.given != 0 {
                let [r, g, b, depth] = block.read(simd, given);
                ([r, g, b], depth)
            } else {
                own_paper(simd, [x * params.grain_frequency, y * params.grain_frequency], params)
            };
            let [r, g, b, a] = block.read(simd, source);
            let alpha = a.within(zero, one);
            let [stroke, ..]: [f32x8<S>; 4] = block.read(simd, strokes);
            let height = mix(tooth, stroke.within(zero, one), zero + params.follow);

            let ([line, kept], paint) = pen(params, block.read(simd, lines));
            let [mark] = block.read(simd, marks);
            let lightness = tone_lightness(block.read(simd, tones));
            let grained = rise((zero + params.smooth_from - lightness) * params.inverse_fade);
            // A dry tool leaves out the valleys of the paper even where it presses hard; in light tones nothing breaks.
            let dry = (height - 0.55).at_least(zero) * params.dryness;
            let pressed = catches(line, height, zero + params.dryness * params.grain) * (one - dry);
            let grain = grained * params.grain;
            let toned = catches(mark, height, grain) * (one - dry * grained) * kept;
            let (ink, of_lines) = inked(params, pressed, toned);
            let ink = ink * alpha;

            // Chalk: the picture's own colours, a little lighter, where the paper catches them.
            let chalk = catches(zero + params.ground, height, grain) * params.colour * alpha;
            let covered = one - (one - ink) * (one - chalk);
            let mut laid = [r, g, b];
            for (channel, value) in laid.iter_mut().enumerate() {
                let own = value.within(zero, one);
                let own_chalk = own * 0.94 + 0.06;
                let mut line = f32x8::splat(simd, params.line[channel]);
                if params.painted != 0 {
                    line += of_lines * (paint[channel] - line);
                }
                let line = mix(line, own * params.tint, zero + params.colour);
                *value = if params.bare != 0 {
                    mix(own_chalk, line, ink / covered.at_least(LEAST_COVERAGE))
                } else {
                    mix(mix(paper[channel] * params.paper[channel], own_chalk, chalk), line, ink)
                };
            }
            let [r, g, b] = laid;
            let sheet = if params.cover != 0 { one } else { a };
            write([r, g, b, if params.bare != 0 { covered } else { sheet }], target);
        },
    );
}

/// Lines of a pixel: how much of it they cover, how much of marks they leave, and their RGB where they have one at each pixel.
#[inline(always)]
fn pen<S: Simd>(params: &Params, [r, g, b, share]: [f32x8<S>; 4]) -> ([f32x8<S>; 2], [f32x8<S>; 3]) {
    let (zero, one) = (f32x8::splat(r.simd, 0.0), f32x8::splat(r.simd, 1.0));
    let [edge, bare] = if params.painted != 0 { [one - share, one + share] } else { [r, g] };
    let kept = one - (one - bare.within(zero, one)) * params.cut;
    ([one - edge.within(zero, one), kept], [r, g, b])
}

/// Ink of lines and of marks together, and the part of it that is lines where these have a colour at each pixel.
#[inline(always)]
fn inked<S: Simd>(params: &Params, lines: f32x8<S>, marks: f32x8<S>) -> (f32x8<S>, f32x8<S>) {
    let one = f32x8::splat(lines.simd, 1.0);
    if params.painted == 0 {
        return ((one - (one - lines) * (one - marks)) * params.line[3], one * 0.0);
    }
    let ink = one - (one - lines) * (one - marks * params.line[3]);
    (ink, lines / ink.at_least(LEAST_COVERAGE))
}

/// The sheet's own paper: its light, and the depth of its grain, at a place in cells of it.
#[inline(always)]
fn own_paper<S: Simd>(simd: S, [x, y]: [f32x8<S>; 2], params: &Params) -> ([f32x8<S>; 3], f32x8<S>) {
    let tooth = even(
        noise(simd, x, y, 11) * 0.45
            + noise(simd, x * 2.13, y * 2.13, 1013) * 0.25
            + noise(simd, x * 0.31, y * 0.31, 2027) * 0.3,
    );
    ([(tooth - 0.5) * params.texture_amount + 1.0; 3], tooth)
}

/// Noise whose values fill 0..=1.
#[inline(always)]
fn even<S: Simd>(v: f32x8<S>) -> f32x8<S> {
    ((v - 0.5) * 1.7 + 0.5).within(0.0, 1.0)
}

/// Ink of density `d` that catches where the height is `h`, for a grain of depth `depth`: as much on the
/// average, more in the one place and less in the other; none is none and solid is solid.
#[inline(always)]
fn catches<S: Simd>(d: f32x8<S>, h: f32x8<S>, depth: f32x8<S>) -> f32x8<S> {
    let one = f32x8::splat(d.simd, 1.0);
    (d + d * (one - d) * (h * -1.0 + 0.5) * (depth * 4.0)).within(0.0, 1.0)
}

/// From `a` at 0 to `b` at 1.
#[inline(always)]
fn mix<S: Simd>(a: f32x8<S>, b: f32x8<S>, t: f32x8<S>) -> f32x8<S> {
    let rest = f32x8::splat(t.simd, 1.0) - t;
    a * rest + b * t
}
