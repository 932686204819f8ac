//! Lays ink, graphite, charcoal or chalk on paper (§ 4.3, 4.4): the response of a difference of Gaussians,
//! roughened by strokes, is thresholded to lines and masses (4.8); shading is hatched or rubbed in; both
//! catch on the paper's grain. Cells of grain and hatching are those of the full-size picture, so that tiles
//! and proxies show the same sheet.
//!
//! Cost: 28 hashes and about 200 multiply-adds per pixel.

pub use crate::kernels::shaders::ink_sheet::Params;
use crate::kernels::shared::value_noise::noise;
use crate::kernels::simd::pixels::{for_blocks, write};
use isophote_engine::dispatch::at_most_avx2;
use isophote_engine::fearless_simd::{Simd, dispatch, f32x8, prelude::*};
use isophote_engine::math::Elementary;
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(ink_sheet {
    cpu: run,
    cost: |_| 500.0,
    tolerance: Tolerance {
        absolute: 2e-3,
        relative: 1e-3,
        outliers: 2e-3,
        reason: "steep ramps magnify the last bits of the response and of the noise's positions",
    },
});

/// What is laid on the paper, and how.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sheet {
    /// RGB and opacity of the ink.
    pub line: [f32; 4],
    /// RGB of the paper; its alpha is not used.
    pub paper: [f32; 4],
    /// Response from which on there is no ink, units of L (4.8).
    pub epsilon: f32,
    /// Steepness of the ramp to ink, per unit of L (4.8).
    pub phi: f32,
    /// Units of L by which strokes raise and lower the response.
    pub carving: f32,
    /// How dark shading is, 0..=2.
    pub shading: f32,
    /// How much of the shading is hatched, 0..=1; the rest is rubbed in.
    pub hatching: f32,
    /// How deep the paper's grain is, 0..=2.
    pub grain: f32,
    /// Size of the grains, pixels of the full-size picture.
    pub grain_size: f32,
    /// Rendered size over full size.
    pub scale: f32,
    /// How much of the picture's own colours shows, 0..=1.
    pub colour: f32,
    /// Strength of the paper's texture, 0..=1.
    pub texture: f32,
    /// How much of the grain follows the strokes instead of the paper, 0..=1.
    pub follow: f32,
    /// Opaque also where the picture is not.
    pub cover: bool,
    /// Where the picture stands in the canonical one, pixels.
    pub origin: [f32; 2],
}

/// Directions of the pencil strokes of light and of deep shades, of length 1.
pub const HATCHING: [[f32; 2]; 2] = [[0.8, -0.6], [0.96, 0.28]];

/// Draws a `response` (units of L) on a sheet, shaded and tinted after `color`; the first channel of
/// `strokes`, 0..=1, roughens it. Pencil strokes stay on the screen unless their heights are given, 0..=1, in light and in
/// deep shades.
pub fn pass(
    plan: &mut PlanBuilder,
    response: ImageId,
    color: ImageId,
    strokes: ImageId,
    hatching: Option<[ImageId; 2]>,
    sheet: &Sheet,
) -> ImageId {
    let params = Params {
        line: sheet.line,
        paper: sheet.paper,
        epsilon: sheet.epsilon,
        phi: sheet.phi,
        carving: sheet.carving,
        shading: sheet.shading.clamp(0.0, 2.0),
        hatching: sheet.hatching,
        grain: sheet.grain.clamp(0.0, 2.0),
        grain_frequency: 1.0 / sheet.grain_size.max(0.1),
        inverse_scale: 1.0 / sheet.scale,
        colour: sheet.colour.clamp(0.0, 1.0),
        texture_amount: sheet.texture,
        cover: sheet.cover.into(),
        follow: sheet.follow,
        origin: sheet.origin,
        given: hatching.is_some().into(),
        padding: Default::default(),
    };
    let [first, second] = hatching.unwrap_or([strokes; 2]);
    let inputs = [response, color, strokes, first, second];
    plan.pass(&KERNEL, &inputs, &params, Class::Colour, Support::Pixels(0))
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    // By AVX-512 it takes a third longer.
    dispatch!(at_most_avx2(pass.level), simd => sheet(simd, pass, &params, band));
}

#[inline(always)]
fn sheet<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, band: &mut Band<'_>) {
    let [response, source, strokes, first_hatching, second_hatching] = pass.inputs else { return };
    let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
    for_blocks::<4>(
        band,
        #[inline(always)]
        |block, target| {
            let columns: f32x8<S> = block.columns(simd).to_float();
            let x = (columns + 0.5 + params.origin[0]) * params.inverse_scale;
            let y = f32x8::splat(simd, (block.y as f32 + 0.5 + params.origin[1]) * params.inverse_scale);
            let (gx, gy) = (x * params.grain_frequency, y * params.grain_frequency);
            let tooth = even(
                noise(simd, gx, gy, 11) * 0.45
                    + noise(simd, gx * 2.13, gy * 2.13, 1013) * 0.25
                    + noise(simd, gx * 0.31, gy * 0.31, 2027) * 0.3,
            );
            let [r, g, b, a] = block.read(simd, source);
            let alpha = a.max(zero).min(one);

            let [stroke, ..]: [f32x8<S>; 4] = block.read(simd, strokes);
            let stroke = stroke.max(zero).min(one);
            let [plain] = block.read(simd, response);
            let u = plain + (stroke * 2.0 - 1.0) * params.carving;
            let below = -((u - params.epsilon) * params.phi).max(-20.0).tanh();
            let lines = u.simd_ge(params.epsilon).select(zero, below);

            let dark = one - (r * 0.2126 + g * 0.7152 + b * 0.0722).max(zero).min(one);
            let (mut first, mut second) = (tooth, tooth);
            if params.hatching > 0.0 {
                let share = f32x8::splat(simd, params.hatching);
                let mut heights = [zero; 2];
                if params.given != 0 {
                    let given: [[f32x8<S>; 4]; 2] =
                        [block.read(simd, first_hatching), block.read(simd, second_hatching)];
                    heights = [given[0][0], given[1][0]];
                } else {
                    heights[0] = hatch(simd, [x, y], HATCHING[0], 301);
                    heights[1] = hatch(simd, [x, y], HATCHING[1], 701);
                }
                (first, second) = (mix(tooth, heights[0], share), mix(tooth, heights[1], share));
            }
            let tone = ((dark * 1.06 - 0.06) * params.shading).max(zero).min(one);
            let deep = ((dark * 1.7 - 0.9) * params.shading).max(zero).min(one);
            // Strokes leave the paper between them; what is rubbed in follows the grain only a little.
            let depth = 0.4 + 1.2 * params.hatching;
            let shade = catches(tone * tone, first, depth).max(catches(deep, second, depth));
            let drawn = one - (one - lines) * (one - shade * 0.75);
            let height = mix(tooth, stroke, zero + params.follow);
            let ink = catches(drawn, height, params.grain)
                * (one - tooth * (0.25 * params.grain))
                * params.line[3]
                * alpha;

            // Chalk: the picture's own colours, a little lighter, where the paper catches them.
            let chalk = catches(zero + 0.72, height, params.grain) * params.colour * alpha;
            let paper = (tooth - 0.5) * params.texture_amount + 1.0;
            let mut laid = [r, g, b];
            for (channel, value) in laid.iter_mut().enumerate() {
                let own = value.max(zero).min(one);
                let sheet = mix(paper * params.paper[channel], own * 0.88 + 0.12, chalk);
                let line = f32x8::splat(simd, params.line[channel]);
                let line = mix(line, own * 0.3, zero + params.colour);
                *value = mix(sheet, line, ink);
            }
            let [r, g, b] = laid;
            write([r, g, b, if params.cover != 0 { one } else { a }], target);
        },
    );
}

/// Noise whose values fill 0..=1.
#[inline(always)]
fn even<S: Simd>(v: f32x8<S>) -> f32x8<S> {
    ((v - 0.5) * 1.7 + 0.5).max(0.0).min(1.0)
}

/// How much ink of density `d` catches where the height is `h`, for a grain of depth `depth`: as much on the
/// average, more in the one place and less in the other; none is none and solid is solid.
#[inline(always)]
fn catches<S: Simd>(d: f32x8<S>, h: f32x8<S>, depth: f32) -> f32x8<S> {
    let one = f32x8::splat(d.simd, 1.0);
    (d + d * (one - d) * (h * -1.0 + 0.5) * (4.0 * depth)).max(0.0).min(1.0)
}

/// Heights of pencil strokes that run along `along`.
#[inline(always)]
fn hatch<S: Simd>(simd: S, [x, y]: [f32x8<S>; 2], along: [f32; 2], seed: u32) -> f32x8<S> {
    let (p, across) = (x * along[0] + y * along[1], y * along[0] - x * along[1]);
    even(noise(simd, p * 0.025, across * 0.45, seed) * 0.7 + noise(simd, p * 0.06, across, seed + 57) * 0.3)
}

/// From `a` at 0 to `b` at 1.
#[inline(always)]
fn mix<S: Simd>(a: f32x8<S>, b: f32x8<S>, t: f32x8<S>) -> f32x8<S> {
    let rest = f32x8::splat(t.simd, 1.0) - t;
    a * rest + b * t
}
