//! Colours of lines, light where the ground around is darker than the line can show, as `light_on_dark` has it of lines of one
//! colour.
//!
//! Cost: a division and 25 multiply-adds per pixel.

pub use crate::kernels::shaders::light_paint::Params;
use crate::kernels::shared::coverage::LEAST_COVERAGE;
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Class, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(light_paint {
    block: |simd, pass, params| |block| {
        let [paint, source, ground] = [0, 1, 2].map(
            #[inline(always)]
            |i: usize| block.read(simd, &pass.inputs[i]),
        );
        turned(&params, paint, source, ground)
    },
    cost: |_| 40.0,
    tolerance: Tolerance::of_rounding(4e-5, 1e-5, "a step of lightness magnifies the rounding of its mean"),
});

/// RGB and opacity of lines; images of these, of the picture beneath, and of the moments of lightness around each pixel
/// ([`lightness_moments`](crate::kernels::lines::lightness_moments)).
pub fn pass(plan: &mut PlanBuilder, images: [ImageId; 3], params: &Params) -> ImageId {
    plan.pass(&KERNEL, &images, params, Class::Colour, Support::Pixels(0))
}

#[inline(always)]
fn turned<S: Simd>(
    params: &Params,
    [r, g, b, opacity]: [f32x8<S>; 4],
    source: [f32x8<S>; 4],
    [sum, _, weight, _]: [f32x8<S>; 4],
) -> [f32x8<S>; 4] {
    let one = f32x8::splat(r.simd, 1.0);
    // Greys have about as much lightness as they have of white.
    let own = (r * 0.2126 + g * 0.7152 + b * 0.0722) * 100.0;
    let strongest = r.at_least(g).at_least(b);
    let weak = ((one * params.strong - strongest) * params.inverse_range).within(0.0, 1.0);
    let dark = (own + params.seen) * weak;
    let mean = sum / weight.at_least(LEAST_COVERAGE);
    let t = ((dark - mean) * params.inverse).within(0.0, 1.0);
    let turned = t * t * (t * -2.0 + 3.0);
    let mut paint = [r, g, b, opacity];
    for (value, source) in paint.iter_mut().zip(source).take(3) {
        let light = source + (one - source) * params.lift;
        *value += turned * (light - *value);
    }
    paint
}
