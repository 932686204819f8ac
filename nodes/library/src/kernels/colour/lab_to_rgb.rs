//! CIELAB to working colour, the reverse of `rgb_to_lab`; alpha passes.
//!
//! Cost: three powers per pixel.

pub use crate::kernels::shaders::lab_to_rgb::Params;
use crate::kernels::shared::colour::{lab_to_linear, srgb_encode};
use crate::kernels::simd::pixels::map_pixels;
use isophote_engine::fearless_simd::dispatch;
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(lab_to_rgb {
    cpu: run,
    cost: |_| 80.0,
    tolerance: Tolerance {
        absolute: 1e-4,
        relative: 2e-4,
        outliers: 2e-3,
        reason: "the slope of the sRGB curve near black is 13, and cubes of f magnify relative errors three \
                 times; a channel that cancels among others near the largest half keeps no digit",
    },
});

/// Adds the pass; `chroma` is the factor on the colour axes a and b.
pub fn pass(plan: &mut PlanBuilder, image: ImageId, chroma: f32) -> ImageId {
    plan.pass(&KERNEL, &[image], &Params { chroma }, Class::Colour, Support::Pixels(0))
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    dispatch!(pass.level, simd => map_pixels(simd, pass, band, #[inline(always)] |[l, a, b, alpha]| {
        let [r, g, b] = srgb_encode(lab_to_linear([l, a * params.chroma, b * params.chroma]));
        [r, g, b, alpha]
    }));
}
