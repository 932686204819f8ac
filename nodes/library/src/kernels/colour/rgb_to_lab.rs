//! Working colour to CIELAB (D65, L in 0..100); alpha passes. Range distances of the bilateral
//! filter and the luminance of the line filters are measured in it (§ 3.2).
//!
//! Cost: six powers per pixel.

pub use crate::kernels::shaders::rgb_to_lab::Params;
use crate::kernels::shared::colour::{linear_to_lab, srgb_decode};
use crate::kernels::simd::pixels::map_pixels;
use isophote_engine::fearless_simd::dispatch;
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(rgb_to_lab {
    cpu: run,
    cost: |_| 130.0,
    tolerance: Tolerance::of_rounding(
        2e-3,
        2e-5,
        "the differences behind a and b magnify the last bits of three powers 500 times"
    ),
});

/// Adds the pass; `chroma` is the factor on the colour axes a and b.
pub fn pass(plan: &mut PlanBuilder, image: ImageId, chroma: f32) -> ImageId {
    plan.pass(&KERNEL, &[image], &Params { chroma }, Class::Colour, Support::Pixels(0))
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    dispatch!(pass.level, simd => map_pixels(simd, pass, band, #[inline(always)] |[r, g, b, alpha]| {
        let [l, a, b] = linear_to_lab(srgb_decode([r, g, b]));
        [l, a * params.chroma, b * params.chroma, alpha]
    }));
}
