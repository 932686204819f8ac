//! Draws lines over a picture, or over paper in its place, as `composite_lines` does (§ 4.6), but
//! light where the ground around is darker than a dark line can show, as an inker draws the folds of a black coat.
//!
//! The mean of the ground decides, not the pixel, so that a line does not change its tone along its length by noise.
//!
//! Cost: a division and 20 multiply-adds per pixel.

pub use crate::kernels::shaders::light_on_dark::Params;
use crate::kernels::shared::coverage::LEAST_COVERAGE;
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Class, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(light_on_dark {
    block: |simd, pass, params| |block| {
        let [edge] = block.read(simd, &pass.inputs[1]);
        drawn(&params, block.read(simd, &pass.inputs[0]), edge, block.read(simd, &pass.inputs[2]))
    },
    cost: |_| 30.0,
    tolerance: Tolerance::of_rounding(2e-5, 1e-5, "a step of lightness magnifies the rounding of its mean"),
});

/// Draws the edges (1 = paper, 0 = line) over a colour, by the moments of lightness around each pixel
/// ([`lightness_moments`](crate::kernels::lines::lightness_moments)); images in this order.
pub fn pass(plan: &mut PlanBuilder, images: [ImageId; 3], params: &Params) -> ImageId {
    plan.pass(&KERNEL, &images, params, Class::Colour, Support::Pixels(0))
}

#[inline(always)]
fn drawn<S: Simd>(
    params: &Params,
    [r, g, b, a]: [f32x8<S>; 4],
    edge: f32x8<S>,
    [sum, _, weight, _]: [f32x8<S>; 4],
) -> [f32x8<S>; 4] {
    let one = f32x8::splat(r.simd, 1.0);
    let ink = (one - edge.within(0.0, 1.0)) * params.line[3];
    let mean = sum / weight.at_least(LEAST_COVERAGE);
    let t = ((one * params.dark - mean) * params.inverse).within(0.0, 1.0);
    let turned = t * t * (t * -2.0 + 3.0);
    let mut pixel = [r, g, b, a];
    for (c, value) in pixel.iter_mut().take(3).enumerate() {
        let [line, light, paper] = [params.line[c], params.light[c], params.paper[c]].map(
            #[inline(always)]
            |v| one * v,
        );
        let base = *value + (paper - *value) * params.paper[3];
        let light = base + (light - base) * params.light[3];
        let over = line + turned * (light - line);
        *value = base + ink * (over - base);
    }
    pixel
}
