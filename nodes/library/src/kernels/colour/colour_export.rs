//! The working colour back to the host's colour.
//!
//! Cost: three powers per pixel.

use crate::colour_space::{ColourSpace, Encoding};
pub use crate::kernels::shaders::colour_export::Params;
use crate::kernels::shared::colour::{LINEAR_TO_ACESCG, srgb_decode, transform};
use crate::kernels::shared::coverage::premultiply;
use crate::kernels::simd::pixels::map_pixels;
use isophote_engine::fearless_simd::dispatch;
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(colour_export {
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

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    dispatch!(pass.level, simd => map_pixels(simd, pass, band, #[inline(always)] |[r, g, b, a]| {
        let mut rgb = [r, g, b];
        if params.space != ColourSpace::Srgb as u32 {
            rgb = srgb_decode(rgb);
        }
        if params.space == ColourSpace::AcesCg as u32 {
            rgb = transform(&LINEAR_TO_ACESCG, rgb);
        }
        if params.premultiplied != 0 {
            return premultiply([rgb[0], rgb[1], rgb[2], a]);
        }
        [rgb[0], rgb[1], rgb[2], a]
    }));
}
