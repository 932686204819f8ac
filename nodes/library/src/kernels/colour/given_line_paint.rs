//! Colours of lines that a host gives, over those that lines have by themselves.
//!
//! Cost: three multiply-adds per pixel.

pub use crate::kernels::shaders::given_line_paint::Params;
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Class, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(given_line_paint {
    block: |simd, pass, params| |block| {
        over(&params, block.read(simd, &pass.inputs[0]), block.read(simd, &pass.inputs[1]))
    },
    cost: |_| 5.0,
    tolerance: Tolerance::of_rounding(1e-6, 1e-6, "a product and a sum"),
});

/// RGB and opacity of lines, which have the opacity of their kinds, or of `line` where they have one colour for all. What is
/// given counts by its alpha.
pub fn pass(plan: &mut PlanBuilder, given: ImageId, kinds: Option<ImageId>, line: [f32; 4]) -> ImageId {
    let params = Params { line, by_kind: kinds.is_some().into(), padding: Default::default() };
    // Where lines have one colour no other image is read: any will do.
    let inputs = [given, kinds.unwrap_or(given)];
    plan.pass(&KERNEL, &inputs, &params, Class::Colour, Support::Pixels(0))
}

#[inline(always)]
fn over<S: Simd>(params: &Params, [r, g, b, alpha]: [f32x8<S>; 4], own: [f32x8<S>; 4]) -> [f32x8<S>; 4] {
    let one = f32x8::splat(r.simd, 1.0);
    let mut line = if params.by_kind > 0 { own } else { params.line.map(|value| one * value) };
    let weight = alpha.within(0.0, 1.0);
    for (value, given) in line.iter_mut().zip([r, g, b]) {
        *value += weight * (given - *value);
    }
    line
}
