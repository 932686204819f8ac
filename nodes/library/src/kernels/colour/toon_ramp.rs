//! Colours of surfaces in steps of light, with a rim and highlights of shapes of their own: cel shading.
//!
//! Every border is a smooth step over the width that it is given, and over a pixel and a half at least, by the gradient of
//! what decides: no border is jagged. Cost: nine powers and about 190 multiply-adds per pixel.

pub use crate::kernels::shaders::toon_ramp::Params;
use crate::kernels::shared::colour::{LUMINANCE, Rgb, srgb_decode, srgb_encode};
use crate::kernels::simd::neighbours::{Neighbours, each};
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(toon_ramp {
    cpu: |simd, pass, params, band| each(
        simd,
        &pass.inputs[0],
        band,
        #[inline(always)]
        |around: Neighbours<'_, _>| shaded(simd, pass, &params, around),
    ),
    cost: |_| 260.0,
    tolerance: Tolerance {
        absolute: 1e-4,
        relative: 5e-5,
        outliers: 1e-3,
        reason: "a border of no width turns on the last bits of the light",
    },
});

/// Steps of light.
pub const STEPS: usize = 6;

/// Step of light.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    /// Gamma-encoded colour, by whose light those of surfaces are multiplied.
    pub tint: [f32; 3],
    /// Light from which on it is, in lightness over 100.
    pub from: f32,
    /// Width of its border, in the same unit.
    pub softness: f32,
}

/// Area of one colour, laid over the steps.
#[derive(Clone, Copy, Debug)]
pub struct Area {
    /// Gamma-encoded colour, and its strength.
    pub colour: [f32; 4],
    /// Where it begins, in the unit of what decides.
    pub from: f32,
    /// Width of its border, in the same unit.
    pub softness: f32,
}

/// Shading in steps.
#[derive(Clone, Copy, Debug)]
pub struct Shading {
    /// The steps from dark to light. The first is where no other is.
    pub steps: [Step; STEPS],
    /// Rim, by how far surfaces turn away.
    pub rim: Area,
    /// Highlights, by mirrored light.
    pub highlight: Area,
}

/// Shades in steps. `light` is a result of [`toon_light`](super::toon_light); `albedo` has the colours of surfaces, and
/// `rest` is added to what becomes of them. Without a rest, `albedo` is a picture with light in it, which is divided out.
pub fn pass(
    plan: &mut PlanBuilder,
    [light, albedo]: [ImageId; 2],
    rest: Option<ImageId>,
    shading: &Shading,
) -> ImageId {
    let Shading { steps, rim, highlight } = shading;
    let params = Params {
        steps: steps.map(|Step { tint: [r, g, b], from, .. }| [r, g, b, from]),
        softness: [0, 1, 2, 3].map(|at: usize| steps[at].softness),
        last_softness: [steps[4].softness, steps[5].softness],
        rim_from: [rim.from, rim.softness],
        rim: rim.colour,
        highlight: highlight.colour,
        highlight_from: [highlight.from, highlight.softness],
        own: rest.is_none().into(),
        padding: Default::default(),
    };
    let inputs = [light, albedo, rest.unwrap_or(albedo)];
    plan.pass(&KERNEL, &inputs, &params, Class::Colour, Support::Pixels(1))
}

/// Narrowest border, pixels, half of it.
const CRISPEST: f32 = 0.75;

/// Luminance below which colours are taken for noise, and become grey.
const GREY: f32 = 0.01;

#[inline(always)]
fn shaded<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, around: Neighbours<'_, S>) -> [f32x8<S>; 4] {
    let alpha = around.centre(3);
    let (light, slope) = (around.centre(0), slope_of(&around, 0));
    let [a, b, c, d] = params.softness;
    let softness = [a, b, c, d, params.last_softness[0], params.last_softness[1]];
    let mut tints = flat(simd, params.steps[0]);
    for step in 1..STEPS {
        tints = mix(
            tints,
            flat(simd, params.steps[step]),
            above(light, params.steps[step][3], softness[step], slope),
        );
    }
    let [r, g, b, covered]: [f32x8<S>; 4] = around.block.read(simd, &pass.inputs[1]);
    let mut colour = srgb_decode([r, g, b]);
    if params.own != 0 {
        let luminance = colour[0] * LUMINANCE[0] + colour[1] * LUMINANCE[1] + colour[2] * LUMINANCE[2];
        let luminance = luminance.at_least(0.0) + GREY;
        for channel in &mut colour {
            *channel = (channel.at_least(0.0) + GREY) / luminance;
        }
    }
    let tints = srgb_decode(tints);
    for c in 0..3 {
        colour[c] *= tints[c];
    }
    let [rim_colour, shine_colour] = [flat(simd, params.rim), flat(simd, params.highlight)];
    let [from, soft] = params.rim_from;
    let rim = above(around.centre(1), from, soft, slope_of(&around, 1)) * params.rim[3];
    let [from, soft] = params.highlight_from;
    let shine = above(around.centre(2), from, soft, slope_of(&around, 2)) * params.highlight[3];
    colour = mix(mix(colour, srgb_decode(rim_colour), rim), srgb_decode(shine_colour), shine);
    if params.own == 0 {
        // As far as the layer covers the picture's pixel.
        let share = (covered / alpha.at_least(1e-4)).within(0.0, 1.0);
        let [r, g, b, _]: [f32x8<S>; 4] = around.block.read(simd, &pass.inputs[2]);
        let rest = srgb_decode([r, g, b]);
        for c in 0..3 {
            colour[c] = colour[c] * share + rest[c];
        }
    }
    let [r, g, b] = srgb_encode(colour);
    [r, g, b, alpha]
}

/// One colour everywhere.
#[inline(always)]
fn flat<S: Simd>(simd: S, [r, g, b, _]: [f32; 4]) -> Rgb<S> {
    [f32x8::splat(simd, r), f32x8::splat(simd, g), f32x8::splat(simd, b)]
}

/// Magnitude of the gradient of a channel, per pixel, by the Sobel operator (2.23).
#[inline(always)]
fn slope_of<S: Simd>(around: &Neighbours<'_, S>, c: usize) -> f32x8<S> {
    let (left_up, left_down) = (around.excess(-1, -1, c), around.excess(-1, 1, c));
    let (right_up, right_down) = (around.excess(1, -1, c), around.excess(1, 1, c));
    let across = (around.excess(1, 0, c) - around.excess(-1, 0, c)) * 0.5;
    let x = across + ((right_up - left_up) + (right_down - left_down)) * 0.25;
    let along = (around.excess(0, 1, c) - around.excess(0, -1, c)) * 0.5;
    let y = along + ((left_down - left_up) + (right_down - right_up)) * 0.25;
    (x * x + y * y).sqrt() * 0.5
}

/// 0 below a border, 1 above it.
#[inline(always)]
fn above<S: Simd>(value: f32x8<S>, from: f32, softness: f32, slope: f32x8<S>) -> f32x8<S> {
    let half_width = (slope * CRISPEST).at_least((0.5 * softness).max(1e-3));
    let t = ((value - from) / (half_width * 2.0) + 0.5).within(0.0, 1.0);
    t * t * (t * -2.0 + 3.0)
}

/// From `a` at 0 to `b` at 1.
#[inline(always)]
fn mix<S: Simd>(a: Rgb<S>, b: Rgb<S>, t: f32x8<S>) -> Rgb<S> {
    [a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t, a[2] + (b[2] - a[2]) * t]
}
