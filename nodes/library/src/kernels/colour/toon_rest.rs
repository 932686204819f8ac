//! Light of a picture that is no light on surfaces: the sky, and what glows by itself.
//!
//! Where diffuse and mirrored light are both known, it is what they leave of the picture; otherwise the picture where no
//! surface has a colour. Cost: twelve powers and about 60 multiply-adds per pixel.

pub use crate::kernels::shaders::toon_rest::Params;
use crate::kernels::shared::colour::{Rgb, srgb_decode, srgb_encode};
use crate::kernels::simd::pixels::{for_blocks, write};
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(toon_rest {
    cpu: |simd, pass, params, band| rests(simd, pass, &params, band),
    cost: |_| 140.0,
    tolerance: Tolerance {
        absolute: 1e-4,
        relative: 2e-5,
        outliers: 1e-3,
        reason: "what layers leave is the difference of like numbers, which the curve makes steep near black",
    },
    fast: Tolerance {
        absolute: 1e-2,
        relative: 4e-3,
        outliers: 1e-2,
        reason: "differences of light as 16-bit floats, which the curve makes steep near black",
    },
});

/// The picture and what is known of it; all gamma-encoded.
#[derive(Clone, Copy, Debug)]
pub struct Layers {
    /// The picture.
    pub color: ImageId,
    /// Colours of surfaces.
    pub albedo: ImageId,
    /// Light that they reflect diffusely, and light that they mirror, where both are known.
    pub reflected: Option<[ImageId; 2]>,
}

/// Adds the pass.
pub fn pass(plan: &mut PlanBuilder, layers: &Layers) -> ImageId {
    let Layers { color, albedo, reflected } = *layers;
    let [diffuse, specular] = reflected.unwrap_or([color; 2]);
    let params = Params { complete: reflected.is_some().into() };
    plan.pass(&KERNEL, &[color, albedo, diffuse, specular], &params, Class::Colour, Support::Pixels(0))
}

/// Colours of surfaces from which on they count as such: 1 / this.
const PRESENT: f32 = 50.0;

/// Rounding of three layers to halves.
const ROUNDING: f32 = 1.004;

#[inline(always)]
fn rests<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, band: &mut Band<'_>) {
    let [color, albedo, diffuse, specular] = pass.inputs else { return };
    for_blocks::<4>(
        band,
        #[inline(always)]
        |block, target| {
            let [r, g, b, alpha]: [f32x8<S>; 4] = block.read(simd, color);
            let all = srgb_decode([r, g, b]);
            let surface = covered(block.read(simd, albedo), alpha);
            let strongest = surface[0].at_least(surface[1]).at_least(surface[2]);
            let absent = (strongest * -PRESENT + 1.0).within(0.0, 1.0);
            let mut rest = [all[0] * absent, all[1] * absent, all[2] * absent];
            if params.complete != 0 {
                let diffuse = covered(block.read(simd, diffuse), alpha);
                let mirrored = covered(block.read(simd, specular), alpha);
                for c in 0..3 {
                    let left = all[c] - (diffuse[c] + mirrored[c]) * ROUNDING;
                    // Surfaces of no colour, such as metals in some renderers, show what they mirror.
                    rest[c] = left.at_least(0.0) + mirrored[c].at_least(0.0) * absent;
                }
            }
            let [r, g, b] = srgb_encode(rest);
            write([r, g, b, alpha], target);
        },
    );
}

/// Linear light of a layer, as far as it covers the picture's pixel.
#[inline(always)]
fn covered<S: Simd>([r, g, b, a]: [f32x8<S>; 4], alpha: f32x8<S>) -> Rgb<S> {
    let share = (a / alpha.at_least(1e-4)).within(0.0, 1.0);
    let [r, g, b] = srgb_decode([r, g, b]);
    [r * share, g * share, b * share]
}
