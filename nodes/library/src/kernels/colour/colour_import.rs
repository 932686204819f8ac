//! The host's colour to the working colour: finite, not premultiplied, gamma-encoded Rec. 709
//! (both extended beyond 0..=1). What lies beyond the largest half float is cut to it, so that squares
//! and sums of colours stay finite; alpha is cut to 0..=1.
//!
//! Cost: three powers and a division per pixel.

use crate::kernels::colour_space::{ACESCG_TO_LINEAR, srgb_encode, transform};
use crate::kernels::support::map_pixels4;
use crate::request::ColourSpace;
use isophote_engine::fearless_simd::{dispatch, f32x8, prelude::*};
use isophote_engine::pixels::LARGEST_HALF;
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::params! {
    /// Uniform block.
    pub struct Params for colour_import {
        /// 0 sRGB, 1 linear Rec. 709, 2 ACEScg.
        pub space: u32,
        /// Nonzero when colour comes multiplied by alpha.
        pub premultiplied: u32,
    }
}

crate::kernel!(colour_import {
    cpu: run,
    cost: |_| 60.0,
    tolerance: Tolerance {
        absolute: 2e-5,
        relative: 2e-5,
        outliers: 0.0,
        reason: "shader powers are exact to a few units in the last place at best",
    },
});

/// Adds the pass.
pub fn import(plan: &mut PlanBuilder, image: ImageId, space: ColourSpace, premultiplied: bool) -> ImageId {
    let params = Params { space: space as u32, premultiplied: premultiplied.into() };
    plan.pass(&KERNEL, &[image], &params, Class::Colour, Support::Pixels(0))
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    dispatch!(pass.level, simd => map_pixels4(simd, pass, band, #[inline(always)] |v| {
        let c = |x: f32| f32x8::splat(simd, x);
        let [r, g, b, a] = v.map(|v| {
            let bounded = v.min(c(LARGEST_HALF)).max(c(-LARGEST_HALF));
            v.is_nan().select(c(0.0), bounded)
        });
        let a = a.min(c(1.0)).max(c(0.0));
        let mut rgb = [r, g, b];
        if params.premultiplied != 0 {
            let covered = a.simd_gt(1e-6);
            rgb = rgb.map(|v| covered.select(v / a, c(0.0)));
        }
        if params.space == ColourSpace::AcesCg as u32 {
            rgb = transform(&ACESCG_TO_LINEAR, rgb);
        }
        if params.space != ColourSpace::Srgb as u32 {
            rgb = srgb_encode(rgb);
        }
        [rgb[0], rgb[1], rgb[2], a]
    }));
}
