//! Lines of an ink sheet ([`ink_sheet`](super::ink_sheet)) with a colour at each pixel.
//!
//! Cost: three multiply-adds per pixel.

pub use crate::kernels::shaders::ink_paint::Params;
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Class, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(ink_paint {
    block: |simd, pass, params| |block| {
        painted(&params, block.read(simd, &pass.inputs[0]), block.read(simd, &pass.inputs[1]))
    },
    cost: |_| 8.0,
    tolerance: Tolerance::of_rounding(1e-6, 1e-6, "a few roundings of shares"),
});

/// RGB, and in alpha how much of the pixel lines cover, below 0 where they are cut out of marks; images of black lines on white,
/// in whose second channel are those that are cut out, and of the RGB and opacity of lines.
pub fn pass(plan: &mut PlanBuilder, [lines, paint]: [ImageId; 2], cut: bool) -> ImageId {
    plan.pass(&KERNEL, &[lines, paint], &Params { cut: f32::from(cut) }, Class::Colour, Support::Pixels(0))
}

#[inline(always)]
fn painted<S: Simd>(
    params: &Params,
    [edge, bare, ..]: [f32x8<S>; 4],
    [r, g, b, opacity]: [f32x8<S>; 4],
) -> [f32x8<S>; 4] {
    let one = f32x8::splat(r.simd, 1.0);
    let covered = (one - edge.within(0.0, 1.0)) * opacity.within(0.0, 1.0);
    let cut = (one - bare.within(0.0, 1.0)) * params.cut;
    [r, g, b, covered - cut]
}
