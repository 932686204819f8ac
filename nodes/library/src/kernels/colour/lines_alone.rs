//! Lines without what they were drawn over (§ 4.6): their colour, and as alpha how much of the pixel they cover, for
//! pictures that are put together elsewhere.
//!
//! The colour is found from the picture with and without the lines, so that lines which turn light on dark ground are light
//! here, too.
//!
//! Cost: a division and six multiply-adds per pixel.

pub use crate::kernels::shaders::lines_alone::Params;
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Class, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(lines_alone {
    block: |simd, pass, params| |block| {
        let [edge] = block.read(simd, &pass.inputs[2]);
        alone(&params, block.read(simd, &pass.inputs[0]), block.read(simd, &pass.inputs[1]), edge)
    },
    cost: |_| 14.0,
    tolerance: Tolerance::of_rounding(
        2e-3,
        1e-5,
        "the share of faint lines magnifies the rounding of a difference"
    ),
});

/// Share of a pixel below which the colour of what covers it is lost in rounding.
const LEAST_SHARE: f32 = 1e-3;

/// The lines of a picture: images of the picture with them, of the same without, and of the edges (1 = paper, 0 = line).
pub fn pass(plan: &mut PlanBuilder, images: [ImageId; 3], opacity: f32) -> ImageId {
    plan.pass(&KERNEL, &images, &Params { opacity }, Class::Colour, Support::Pixels(0))
}

#[inline(always)]
fn alone<S: Simd>(
    params: &Params,
    drawn: [f32x8<S>; 4],
    source: [f32x8<S>; 4],
    edge: f32x8<S>,
) -> [f32x8<S>; 4] {
    let one = f32x8::splat(edge.simd, 1.0);
    let share = (one - edge.within(0.0, 1.0)) * params.opacity;
    let divisor = share.at_least(LEAST_SHARE);
    let mut pixel = source;
    for (value, drawn) in pixel.iter_mut().zip(drawn).take(3) {
        *value = (*value + (drawn - *value) / divisor).within(0.0, 1.0);
    }
    pixel[3] = share * source[3].within(0.0, 1.0);
    pixel
}
