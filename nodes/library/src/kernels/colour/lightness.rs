//! Lightness L (0..100) and coverage of a colour, as (L alpha, alpha): what the line filters work on
//! (§ 4.6). Both are linear, so that smoothing and interpolation weight by coverage of themselves.
//!
//! Cost: four powers per pixel; none when the source is Lab already.

use crate::kernels::blocks::{for_blocks, write2};
use crate::kernels::colour_space::{LUMINANCE, lab_curve, srgb_decode};
use isophote_engine::fearless_simd::dispatch;
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::params! {
    /// Uniform block.
    pub struct Params for lightness {
        /// 0 working colour, 1 Lab.
        pub source_space: u32,
    }
}

crate::kernel!(lightness {
    cpu: run,
    cost: |_| 80.0,
    tolerance: Tolerance {
        absolute: 1e-3,
        relative: 2e-5,
        outliers: 0.0,
        reason: "powers exact to a few units in the last place, and the slope of L near black is 900",
    },
});

/// (L alpha, alpha) of a working colour.
pub fn of_color(plan: &mut PlanBuilder, color: ImageId) -> ImageId {
    plan.pass(&KERNEL, &[color], &Params { source_space: 0 }, Class::Field, Support::Pixels(0))
}

/// (L alpha, alpha) of a Lab image.
pub fn of_lab(plan: &mut PlanBuilder, lab: ImageId) -> ImageId {
    plan.pass(&KERNEL, &[lab], &Params { source_space: 1 }, Class::Field, Support::Pixels(0))
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    let view = &pass.inputs[0];
    dispatch!(pass.level, simd => for_blocks::<2>(band, #[inline(always)] |block, target| {
        let [r, g, b, alpha] = block.read4(simd, view);
        let mut lightness = r;
        if params.source_space == 0 {
            let [r, g, b] = srgb_decode([r, g, b]);
            let y = r * LUMINANCE[0] + g * LUMINANCE[1] + b * LUMINANCE[2];
            lightness = lab_curve(y) * 116.0 - 16.0;
        }
        write2([lightness * alpha, alpha], target);
    }));
}
