//! Light on surfaces as steps of shading see it: how bright it is, how far surfaces turn away, and how much they mirror, each
//! in a channel, with the coverage of the picture in the fourth.
//!
//! Light is measured by its luminance over that of the surface, and given as CIELAB lightness over 100: steps that are even
//! there look even. Cost: five powers and about 60 multiply-adds per pixel.

pub use crate::kernels::shaders::toon_light::Params;
use crate::kernels::shared::colour::{LUMINANCE, lab_curve, srgb_decode};
use crate::kernels::shared::host_colour::finite_pixels;
use crate::kernels::simd::pixels::{for_blocks, write};
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(toon_light {
    cpu: |simd, pass, params, band| lights(simd, pass, &params, band),
    cost: |_| 160.0,
    tolerance: Tolerance {
        absolute: 2e-5,
        relative: 2e-5,
        outliers: 1e-3,
        reason: "powers are exact to a few units in the last place, and dark surfaces magnify what they reflect",
    },
});

/// Layers of a picture that tell its light; all colours are gamma-encoded.
#[derive(Clone, Copy, Debug)]
pub struct Layers {
    /// The picture.
    pub color: ImageId,
    /// Light of surfaces in their colours.
    pub lit: ImageId,
    /// Colours of surfaces, by which `lit` is divided where they are there.
    pub albedo: Option<ImageId>,
    /// Light that surfaces mirror; `lit` stands for it where it is not there.
    pub specular: Option<ImageId>,
    /// View-space normals.
    pub normal: Option<ImageId>,
    /// True where `lit` is light that is reflected diffusely, of which metals have none.
    pub is_diffuse: bool,
}

/// Adds the pass; `gain` is a factor on light.
pub fn pass(plan: &mut PlanBuilder, layers: &Layers, gain: f32) -> ImageId {
    let Layers { color, lit, albedo, specular, normal, is_diffuse } = *layers;
    let bit = |is_there: bool, bit: u32| if is_there { bit } else { 0 };
    let replaces = is_diffuse && albedo.is_some() && specular.is_some();
    let given =
        bit(albedo.is_some(), 1) | bit(specular.is_some(), 2) | bit(replaces, 4) | bit(normal.is_some(), 8);
    let inputs = [color, lit, albedo.unwrap_or(color), specular.unwrap_or(color), normal.unwrap_or(color)];
    plan.pass(&KERNEL, &inputs, &Params { given, gain }, Class::Field, Support::Pixels(0))
}

/// Darker surfaces show no light of their own.
const DARKEST: f32 = 1e-3;

#[inline(always)]
fn lights<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, band: &mut Band<'_>) {
    let [color, lit, albedo, specular, normal] = pass.inputs else { return };
    let is_given = |bit: u32| params.given & bit != 0;
    let zero = f32x8::splat(simd, 0.0);
    for_blocks::<4>(
        band,
        #[inline(always)]
        |block, target| {
            let [_, _, _, alpha]: [f32x8<S>; 4] = block.read(simd, color);
            let mut light = luminance(block.read(simd, lit));
            let mut mirrored = light;
            if is_given(2) {
                mirrored = luminance(block.read(simd, specular));
            }
            if is_given(1) {
                let surface = luminance(block.read(simd, albedo)) + DARKEST;
                light /= surface;
                if is_given(4) {
                    // Metals reflect nothing diffusely.
                    let metal = (light * -50.0 + 1.0).within(0.0, 1.0);
                    light += mirrored / surface * metal;
                }
            }
            let mut away = zero;
            if is_given(8) {
                let [x, y, z, w]: [f32x8<S>; 4] = block.read(simd, normal);
                let [x, y, z, w] = finite_pixels([x, y, z, w]);
                let length = (x * x + y * y + z * z).sqrt();
                let facing = (z / length.at_least(1e-6)).within(0.0, 1.0);
                away = length.simd_gt(1e-6).select(zero + 1.0 - facing, zero) * w;
            }
            write([lightness(light * params.gain), away, lightness(mirrored * params.gain), alpha], target);
        },
    );
}

/// Luminance of a gamma-encoded colour.
#[inline(always)]
fn luminance<S: Simd>([r, g, b, _]: [f32x8<S>; 4]) -> f32x8<S> {
    let [r, g, b] = srgb_decode([r, g, b]);
    (r * LUMINANCE[0] + g * LUMINANCE[1] + b * LUMINANCE[2]).at_least(0.0)
}

/// Lightness of CIELAB over 100, as far as twice that of white.
#[inline(always)]
fn lightness<S: Simd>(luminance: f32x8<S>) -> f32x8<S> {
    (lab_curve(luminance) * 1.16 - 0.16).within(0.0, 2.0)
}
