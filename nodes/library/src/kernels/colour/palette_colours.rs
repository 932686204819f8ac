//! Colours of a palette in the place of those of a picture: the nearest in CIELAB, or, by ordered dither (Bayer 1973), that
//! or a second one, whichever the threshold of the place says. What is written is copied from the palette and never
//! computed.
//!
//! The second colour is where the line from the nearest one on leads nearest to what is wanted; of colours in about one
//! direction it is the nearest, so that dither stays fine. The share along that line, in CIELAB, is compared with the
//! threshold. Cost: per pixel about 10 operations for each colour of the palette, 20 more where it dithers.

pub use crate::kernels::shaders::palette_colours::Params;
use crate::kernels::shared::colour::{Rgb, linear_to_lab, srgb_decode};
use crate::kernels::simd::pixels::{BLOCK, Block, for_blocks, read, write};
use isophote_engine::fearless_simd::{Level, Simd, dispatch, f32x8, i32x8, mask32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(palette_colours {
    cpu: |simd, pass, params, band| painted(simd, pass, &params, band),
    cost: |p| f64::from(p.count) * if p.spread > 0.0 { 30.0 } else { 10.0 } + 20.0,
    tolerance: Tolerance {
        absolute: 1e-6,
        relative: 0.0,
        outliers: 4e-3,
        reason: "colours are copied; where two are equally near, or a share meets its threshold, the last bit decides",
    },
});

/// Rows and columns of a dither pattern.
pub const SIDE: usize = 32;
/// Most colours of a palette.
pub const MOST: usize = 64;

/// Thresholds of a dither pattern in 0..1, row by row, four to a vector. It is repeated over the picture.
pub type Pattern = [[f32; 4]; SIDE * SIDE / 4];

/// Palette and dither; lengths in pixels of the picture that is rendered.
#[derive(Clone, Copy, Debug)]
pub struct Options<'a> {
    /// Gamma-encoded RGB of the colours, 1..=[`MOST`].
    pub colours: &'a [[f32; 3]],
    /// How much the picture's lightness, 0..=100, is brought into the range of the palette's, 0..=1.
    pub fit: f32,
    /// How far from the middle between two colours dither reaches, 0..=1; 0 takes the nearest colour.
    pub spread: f32,
    /// Thresholds of the dither.
    pub pattern: &'a Pattern,
    /// Size of a threshold; a pixel at least, so that proxies have all thresholds.
    pub cell: f32,
    /// Position of the picture in the canonical one.
    pub origin: [f32; 2],
}

/// Thresholds that nothing is compared with.
static NO_PATTERN: Pattern = [[0.0; 4]; SIDE * SIDE / 4];

impl<'a> Options<'a> {
    /// The nearest of the colours for each pixel, with tones brought `fit` of the way to theirs.
    pub fn nearest(colours: &'a [[f32; 3]], fit: f32) -> Self {
        Self { colours, fit, spread: 0.0, pattern: &NO_PATTERN, cell: 1.0, origin: [0.0; 2] }
    }
}

/// Paints a Lab image in the colours of a palette. The result is gamma-encoded RGB.
pub fn pass(plan: &mut PlanBuilder, lab: ImageId, options: &Options<'_>) -> ImageId {
    let count = options.colours.len().clamp(1, MOST);
    let colours = padded(options.colours);
    let labs = labs(&colours);
    let lightness = labs[..count].iter().map(|lab| lab[0]);
    let (low, high) = lightness.fold((100.0f32, 0.0f32), |(low, high), l| (low.min(l), high.max(l)));
    let fit = options.fit;
    let params = Params {
        thresholds: *options.pattern,
        labs,
        colours,
        origin: options.origin,
        tone: [1.0 + fit * (0.01 * (high - low) - 1.0), fit * low],
        frequency: 1.0 / options.cell.max(1.0),
        spread: options.spread,
        count: count as u32,
        padding: Default::default(),
    };
    plan.pass(&KERNEL, &[lab], &params, Class::Colour, Support::Pixels(0))
}

/// Colours of a palette, opaque, and black in the places that it leaves.
pub fn padded(palette: &[[f32; 3]]) -> [[f32; 4]; MOST] {
    let mut colours = [[0.0; 4]; MOST];
    for (colour, [r, g, b]) in colours.iter_mut().zip(palette) {
        *colour = [*r, *g, *b, 1.0];
    }
    colours
}

/// CIELAB of gamma-encoded colours, by the arithmetic that pictures go through: a picture that has these colours is at no
/// distance from them.
pub fn labs(colours: &[[f32; 4]; MOST]) -> [[f32; 4]; MOST] {
    let mut labs = [[0.0; 4]; MOST];
    dispatch!(Level::new(), simd => {
        for (colours, labs) in colours.chunks_exact(BLOCK).zip(labs.chunks_exact_mut(BLOCK)) {
            let [r, g, b, _]: [f32x8<_>; 4] = read(simd, colours.as_flattened());
            let [l, a, b] = linear_to_lab(srgb_decode([r, g, b]));
            write([l, a, b, f32x8::splat(simd, 0.0)], labs.as_flattened_mut());
        }
    });
    labs
}

/// How much nearer a second colour must lead to what is wanted, the farther it is, 1 / CIELAB units squared.
const COMPACT: f32 = 4e-5;
/// Range of what is compared, to both sides of 0, CIELAB units: beyond it distances lose their last bits.
const REACH: f32 = 300.0;

#[inline(always)]
fn painted<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, band: &mut Band<'_>) {
    let count = params.count.clamp(1, MOST as u32) as usize;
    let labs = &params.labs[..count];
    for_blocks::<4>(
        band,
        #[inline(always)]
        |block, target| {
            let [l, a, b, alpha]: [f32x8<S>; 4] = block.read(simd, &pass.inputs[0]);
            let wanted = [
                (l * params.tone[0] + params.tone[1]).within(-REACH, REACH),
                a.within(-REACH, REACH),
                b.within(-REACH, REACH),
            ];
            let nearest = nearest(simd, labs, wanted);
            let mut chosen = nearest.index;
            if params.spread > 0.0 {
                let (second, share) = second(simd, labs, wanted, &nearest);
                // Where light and dark meet, thresholds say which pixels are light whichever of the two is nearer.
                let lighter = second.lab[0].simd_gt(nearest.lab[0]);
                let light = lighter.select(share, f32x8::splat(simd, 1.0) - share) - 0.5;
                let threshold = (thresholds(simd, params, block) - 0.5) * params.spread;
                let is_light = light.simd_gt(threshold);
                let of_lighter = lighter.select(second.index, nearest.index);
                let of_darker = lighter.select(nearest.index, second.index);
                chosen = is_light.select(of_lighter, of_darker);
            }
            let [r, g, b] = copied(simd, params, chosen);
            write([r, g, b, alpha], target);
        },
    );
}

/// Colours of the palette.
#[derive(Clone, Copy)]
struct Found<S: Simd> {
    /// Their places in it, whole numbers.
    index: f32x8<S>,
    lab: Rgb<S>,
    /// Squares of their distances from what is wanted.
    apart: f32x8<S>,
}

/// The colours nearest to those that are wanted, the first of several.
#[inline(always)]
fn nearest<S: Simd>(simd: S, labs: &[[f32; 4]], wanted: Rgb<S>) -> Found<S> {
    let zero = f32x8::splat(simd, 0.0);
    let mut found = Found { index: zero, lab: flat(simd, labs[0]), apart: f32x8::splat(simd, 1e30) };
    for (index, lab) in labs.iter().enumerate() {
        let lab = flat(simd, *lab);
        let apart = square(difference(wanted, lab));
        let nearer = apart.simd_lt(found.apart);
        found.index = nearer.select(f32x8::splat(simd, index as f32), found.index);
        found.apart = nearer.select(apart, found.apart);
        found.lab = either(nearer, lab, found.lab);
    }
    found
}

/// The colours to which the lines from the nearest ones lead past what is wanted, and the share of the way; the nearest
/// ones where no line leads there.
#[inline(always)]
fn second<S: Simd>(simd: S, labs: &[[f32; 4]], wanted: Rgb<S>, nearest: &Found<S>) -> (Found<S>, f32x8<S>) {
    let zero = f32x8::splat(simd, 0.0);
    let d = difference(wanted, nearest.lab);
    let (mut found, mut share, mut best) = (*nearest, zero, f32x8::splat(simd, -1e30));
    for (index, lab) in labs.iter().enumerate() {
        let lab = flat(simd, *lab);
        let line = difference(lab, nearest.lab);
        let along = dot(d, line);
        let length = square(line);
        let part = along / length.at_least(1e-6);
        let merit = along * part - length * nearest.apart * COMPACT;
        let better = along.simd_gt(zero) & merit.simd_gt(best);
        best = better.select(merit, best);
        share = better.select(part, share);
        found.index = better.select(f32x8::splat(simd, index as f32), found.index);
        found.lab = either(better, lab, found.lab);
    }
    (found, share)
}

/// Thresholds of the pixels of a block.
#[inline(always)]
fn thresholds<S: Simd>(simd: S, params: &Params, block: Block) -> f32x8<S> {
    let mask = i32x8::splat(simd, SIDE as i32 - 1);
    let [x, y] = block.centres(simd);
    let column: i32x8<S> = ((x + params.origin[0]) * params.frequency).floor().to_int();
    let row: i32x8<S> = ((y + params.origin[1]) * params.frequency).floor().to_int();
    let at = (row & mask) * SIDE as i32 + (column & mask);
    let values = params.thresholds.as_flattened();
    let mut found = [0.0; BLOCK];
    for lane in 0..BLOCK {
        found[lane] = values[at[lane] as usize];
    }
    f32x8::from_slice(simd, &found)
}

/// The colours of these places of the palette.
#[inline(always)]
fn copied<S: Simd>(simd: S, params: &Params, index: f32x8<S>) -> Rgb<S> {
    let mut found = [[0.0; BLOCK]; 3];
    for lane in 0..BLOCK {
        let colour = params.colours[index[lane] as usize];
        for c in 0..3 {
            found[c][lane] = colour[c];
        }
    }
    [
        f32x8::from_slice(simd, &found[0]),
        f32x8::from_slice(simd, &found[1]),
        f32x8::from_slice(simd, &found[2]),
    ]
}

/// One colour everywhere.
#[inline(always)]
fn flat<S: Simd>(simd: S, [l, a, b, _]: [f32; 4]) -> Rgb<S> {
    [f32x8::splat(simd, l), f32x8::splat(simd, a), f32x8::splat(simd, b)]
}

/// The colour `a` where `mask` is set, else `b`.
#[inline(always)]
fn either<S: Simd>(mask: mask32x8<S>, a: Rgb<S>, b: Rgb<S>) -> Rgb<S> {
    [mask.select(a[0], b[0]), mask.select(a[1], b[1]), mask.select(a[2], b[2])]
}

#[inline(always)]
fn difference<S: Simd>(a: Rgb<S>, b: Rgb<S>) -> Rgb<S> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
fn dot<S: Simd>(a: Rgb<S>, b: Rgb<S>) -> f32x8<S> {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn square<S: Simd>(a: Rgb<S>) -> f32x8<S> {
    dot(a, a)
}
