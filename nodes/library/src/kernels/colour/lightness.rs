//! Lightness L (0..100) and coverage of a colour, as (L alpha, alpha): what the line filters work on
//! (§ 4.6). Both are linear, so that smoothing and interpolation weight by coverage of themselves.
//!
//! If the working colour comes from the host unchanged, the host's own is read: the working colour
//! need not exist then, and linear light is not encoded to be decoded again.
//!
//! Cost: four powers per pixel; one for a host's linear light, none when the source is Lab already.

use crate::colour_space::ColourSpace;
use crate::kernels::colour::colour_import;
pub use crate::kernels::shaders::lightness::Params;
use crate::kernels::shared::colour::{ACESCG_TO_LINEAR, LUMINANCE, lab_curve, srgb_decode, transform};
use crate::kernels::shared::host_colour::plain;
use crate::kernels::simd::pixels::map_pairs;
use isophote_engine::fearless_simd::{Simd, dispatch, f32x8};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

const WORKING: u32 = 0;
const LAB: u32 = 1;
const HOST: u32 = 2;

crate::kernel!(lightness {
    cpu: run,
    cost: |_| 80.0,
    tolerance: Tolerance::of_rounding(
        1e-3,
        2e-5,
        "powers exact to a few units in the last place, and the slope of L near black is 900"
    ),
});

/// (L alpha, alpha) of a working colour.
pub fn pass(plan: &mut PlanBuilder, color: ImageId) -> ImageId {
    let (image, params) = match colour_import::imported(plan, color) {
        Some((image, colour_import::Params { space, premultiplied })) => {
            (image, Params { source_space: HOST, space, premultiplied })
        }
        None => (color, Params { source_space: WORKING, space: 0, premultiplied: 0 }),
    };
    plan.pass(&KERNEL, &[image], &params, Class::Colour, Support::Pixels(0))
}

/// (L alpha, alpha) of a Lab image.
pub fn pass_lab(plan: &mut PlanBuilder, lab: ImageId) -> ImageId {
    let params = Params { source_space: LAB, space: 0, premultiplied: 0 };
    plan.pass(&KERNEL, &[lab], &params, Class::Colour, Support::Pixels(0))
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    dispatch!(pass.level, simd => map_pairs(simd, pass, band, #[inline(always)] |[mut v, mut w]: [[f32x8<_>; 4]; 2]| {
        if params.source_space != LAB {
            // Two blocks side by side: their operations need not wait for each other.
            (v, w) = (luminance(&params, v), luminance(&params, w));
            (v[0], w[0]) = (lab_curve(v[0]) * 116.0 - 16.0, lab_curve(w[0]) * 116.0 - 16.0);
        }
        [[v[0] * v[3], v[3]], [w[0] * w[3], w[3]]]
    }));
}

/// Pixels with their luminance in the first channel.
#[inline(always)]
fn luminance<S: Simd>(params: &Params, mut pixels: [f32x8<S>; 4]) -> [f32x8<S>; 4] {
    let host = params.source_space == HOST;
    if host {
        pixels = plain(pixels, params.premultiplied);
    }
    let [mut r, mut g, mut b, a] = pixels;
    if !host || params.space == ColourSpace::Srgb as u32 {
        [r, g, b] = srgb_decode([r, g, b]);
    } else if params.space == ColourSpace::AcesCg as u32 {
        [r, g, b] = transform(&ACESCG_TO_LINEAR, [r, g, b]);
    }
    [r * LUMINANCE[0] + g * LUMINANCE[1] + b * LUMINANCE[2], g, b, a]
}
