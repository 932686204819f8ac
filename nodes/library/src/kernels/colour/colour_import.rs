//! The host's colour to the working colour: finite, not premultiplied, gamma-encoded Rec. 709
//! (both extended beyond 0..=1). What lies beyond the largest half float is cut to it, so that squares
//! and sums of colours stay finite; alpha is cut to 0..=1.
//!
//! Cost: three powers and a division per pixel.

use crate::colour_space::{ColourSpace, Encoding};
pub use crate::kernels::shaders::colour_import::Params;
use crate::kernels::shared::colour::{ACESCG_TO_LINEAR, srgb_encode, transform};
use crate::kernels::shared::host_colour::plain;
use crate::kernels::simd::pixels::map_pixels;
use isophote_engine::fearless_simd::dispatch;
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(colour_import {
    cpu: run,
    cost: |_| 60.0,
    tolerance: Tolerance::of_rounding(
        2e-5,
        2e-5,
        "shader powers are exact to a few units in the last place at best"
    ),
});

/// Adds the pass.
pub fn pass(plan: &mut PlanBuilder, image: ImageId, host: Encoding) -> ImageId {
    let params = Params { space: host.space as u32, premultiplied: host.alpha() };
    plan.pass(&KERNEL, &[image], &params, Class::Colour, Support::Pixels(0))
}

/// The host's image that `color` was made from by [`pass`], and how; none for any other image. What it
/// is for: a kernel that needs other values of the host's colour than the working ones takes them from
/// there, and the pass is left out if nobody else reads it.
pub fn imported(plan: &PlanBuilder, color: ImageId) -> Option<(ImageId, Params)> {
    let pass = plan.made_by(color).filter(|pass| std::ptr::eq(pass.kernel, &KERNEL))?;
    Some((*pass.inputs.first()?, bytemuck::pod_read_unaligned(&pass.params)))
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    dispatch!(pass.level, simd => map_pixels(simd, pass, band, #[inline(always)] |pixels| {
        let [r, g, b, a] = plain(pixels, params.premultiplied);
        let mut rgb = [r, g, b];
        if params.space == ColourSpace::AcesCg as u32 {
            rgb = transform(&ACESCG_TO_LINEAR, rgb);
        }
        if params.space != ColourSpace::Srgb as u32 {
            rgb = srgb_encode(rgb);
        }
        [rgb[0], rgb[1], rgb[2], a]
    }));
}
