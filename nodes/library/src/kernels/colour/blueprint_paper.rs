//! The sheet of a blueprint: tinted paper with texture and grid, a hint of the picture's tones and the
//! lines. All lengths and the texture's cells are those of the full-size picture, so that tiles and
//! proxies show the same sheet; a paper may be given, too.
//!
//! Cost: twelve hashes and about 100 multiply-adds per pixel.

pub use crate::kernels::shaders::blueprint_paper::Params;
use crate::kernels::shared::value_noise::noise;
use crate::kernels::simd::pixels::{for_blocks, write};
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(blueprint_paper {
    cpu: |simd, pass, params, band| sheet(simd, pass, &params, band),
    cost: |_| 200.0,
    tolerance: Tolerance {
        absolute: 1e-4,
        relative: 1e-5,
        outliers: 1e-3,
        reason: "cells and grid lines are placed by divisions exact to a few units in the last place",
    },
});

/// Appearance of a sheet; lengths in pixels of the picture that is rendered.
#[derive(Clone, Copy, Debug)]
pub struct Sheet {
    /// RGB and opacity of the lines.
    pub line: [f32; 4],
    /// RGB of the paper; its alpha is not used.
    pub paper: [f32; 4],
    /// Pixels between grid lines, every fifth of them strong; 0 for none.
    pub spacing: f32,
    /// Rendered size over full size.
    pub scale: f32,
    /// Strength of the paper's texture, 0..=1.
    pub texture: f32,
    /// Share of the picture's tones that shows, 0..=1.
    pub fill: f32,
    /// Opaque also where the picture is not.
    pub cover: bool,
    /// Position of the picture in the canonical one, pixels.
    pub origin: [f32; 2],
}

/// What is drawn, and on what.
#[derive(Clone, Copy, Debug)]
pub struct Drawing {
    /// (L alpha, alpha) of the picture.
    pub lightness: ImageId,
    /// 1 = paper, 0 = line; none where others draw the lines.
    pub edges: Option<ImageId>,
    /// Colours of a paper ([`paper_relief`](super::paper_relief)).
    pub paper: Option<ImageId>,
}

/// Draws lines on a sheet shaded after the lightness.
pub fn pass(plan: &mut PlanBuilder, drawing: &Drawing, sheet: &Sheet) -> ImageId {
    let params = Params {
        line: sheet.line,
        paper: sheet.paper,
        spacing: sheet.spacing,
        scale: sheet.scale,
        inverse_scale: 1.0 / sheet.scale,
        texture_amount: sheet.texture,
        fill: sheet.fill,
        cover: sheet.cover.into(),
        origin: sheet.origin,
        given: drawing.paper.is_some().into(),
        lined: drawing.edges.is_some().into(),
        padding: Default::default(),
    };
    let [edges, paper] = [drawing.edges, drawing.paper].map(|image| image.unwrap_or(drawing.lightness));
    let inputs = [drawing.lightness, edges, paper];
    plan.pass(&KERNEL, &inputs, &params, Class::Colour, Support::Pixels(0))
}

#[inline(always)]
fn sheet<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, band: &mut Band<'_>) {
    let (lightness, edges) = (&pass.inputs[0], &pass.inputs[1]);
    let one = f32x8::splat(simd, 1.0);
    for_blocks::<4>(
        band,
        #[inline(always)]
        |block, target| {
            let columns: f32x8<S> = block.columns(simd).to_float();
            let x = columns + 0.5 + params.origin[0];
            let y = f32x8::splat(simd, block.y as f32 + 0.5 + params.origin[1]);
            let (qx, qy) = (x * params.inverse_scale, y * params.inverse_scale);
            let paper = if params.given != 0 {
                let [r, g, b, _]: [f32x8<S>; 4] = block.read(simd, &pass.inputs[2]);
                [r, g, b]
            } else {
                let grain = noise(simd, qx * 0.4, qy * 0.4, 0) * 0.45
                    + noise(simd, qx * 0.13, qy * 0.13, 1013) * 0.3
                    + noise(simd, qx * 0.037, qy * 0.037, 2027) * 0.25;
                [(grain - 0.5) * params.texture_amount + 1.0; 3]
            };
            let [l, alpha] = block.read(simd, lightness);
            let tone = (l / alpha.at_least(1e-6) * 0.01).within(0.0, 1.0);
            let fill = alpha.within(0.0, 1.0) * params.fill;
            let shade = one - fill * 0.5 * (one - tone);
            let light = fill * 0.35 * tone;
            let mut rule = one * 0.0;
            if params.spacing > 0.0 {
                let fine = ruled(x, y, params.spacing, params.scale) * 0.16;
                let strong = ruled(x, y, 5.0 * params.spacing, 1.5 * params.scale) * 0.32;
                rule = fine.at_least(strong) * params.line[3];
            }
            let mut ink = one * 0.0;
            if params.lined != 0 {
                let [edge] = block.read(simd, edges);
                ink = (one - edge.within(0.0, 1.0)) * params.line[3];
            }
            let drawn = Drawn { paper, shade, light, rule, ink };
            let [r, g, b] = [drawn.over(params, 0), drawn.over(params, 1), drawn.over(params, 2)];
            write([r, g, b, if params.cover != 0 { one } else { alpha }], target);
        },
    );
}

/// Shares of what lies on the paper.
#[derive(Clone, Copy)]
struct Drawn<S: Simd> {
    paper: [f32x8<S>; 3],
    shade: f32x8<S>,
    light: f32x8<S>,
    rule: f32x8<S>,
    ink: f32x8<S>,
}

impl<S: Simd> Drawn<S> {
    /// One channel of the sheet.
    #[inline(always)]
    fn over(&self, params: &Params, channel: usize) -> f32x8<S> {
        let line = f32x8::splat(self.ink.simd, params.line[channel]);
        let sheet = self.paper[channel] * self.shade * params.paper[channel];
        let sheet = sheet + self.light * (line - sheet);
        let sheet = sheet + self.rule * (line - sheet);
        sheet + self.ink * (line - sheet)
    }
}

/// Share of the pixels at (x, y) that is covered by lines `width` wide, `spacing` apart.
#[inline(always)]
fn ruled<S: Simd>(x: f32x8<S>, y: f32x8<S>, spacing: f32, width: f32) -> f32x8<S> {
    ruled_along(x, spacing, width).at_least(ruled_along(y, spacing, width))
}

#[inline(always)]
fn ruled_along<S: Simd>(x: f32x8<S>, spacing: f32, width: f32) -> f32x8<S> {
    let offset = x - ((x / spacing).floor() + 0.5) * spacing;
    let reach = f32x8::splat(x.simd, 0.5 + 0.5 * width);
    (reach - offset.abs()).within(0.0, width.min(1.0))
}
