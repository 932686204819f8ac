//! Draws lines over a picture in a colour for each pixel, as `composite_lines` does in one (§ 4.6); coverage stays.
//!
//! Cost: six multiply-adds per pixel.

use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Class, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(painted_lines {
    block: |simd, pass| |block| {
        let [edge] = block.read(simd, &pass.inputs[1]);
        drawn(block.read(simd, &pass.inputs[0]), edge, block.read(simd, &pass.inputs[2]))
    },
    cost: |_| 8.0,
    tolerance: Tolerance::of_rounding(1e-6, 2e-6, "a few roundings"),
});

/// Draws the edges (1 = paper, 0 = line) over a picture; images of the picture, the edges, and the RGB of lines.
pub fn pass(plan: &mut PlanBuilder, images: [ImageId; 3]) -> ImageId {
    plan.pass(&KERNEL, &images, &(), Class::Colour, Support::Pixels(0))
}

#[inline(always)]
fn drawn<S: Simd>(source: [f32x8<S>; 4], edge: f32x8<S>, paint: [f32x8<S>; 4]) -> [f32x8<S>; 4] {
    let ink = f32x8::splat(edge.simd, 1.0) - edge.within(0.0, 1.0);
    let mut pixel = source;
    for channel in 0..3 {
        pixel[channel] += ink * (paint[channel] - source[channel]);
    }
    pixel
}
