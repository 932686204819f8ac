//! The light of a picture beyond what its coverage can carry ([`beyond_coverage`]), as an opaque picture in the
//! host's own space.
//!
//! Fire, glows and additive renders have colour where coverage is 0 or little: no straight colour could stand for
//! it. It is taken apart on entry, filtered as light, and added to the result.
//!
//! Cost: about ten operations.

use crate::kernels::shared::host_colour::{beyond_coverage, finite_pixels};
use crate::kernels::simd::pixels::map_pixels;
use isophote_engine::fearless_simd::{f32x8, prelude::*};
use isophote_engine::{Class, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(emission {
    cpu: |simd, pass, band| map_pixels(
        simd,
        pass,
        band,
        #[inline(always)]
        |pixels| {
            let [r, g, b] = beyond_coverage(finite_pixels(pixels));
            [r, g, b, f32x8::splat(simd, 1.0)]
        },
    ),
    cost: |_| 10.0,
    tolerance: Tolerance::of_rounding(1e-6, 1e-6, "a fourth power and a quotient of a few roundings"),
});

/// Adds the pass; `image` is the host's, premultiplied.
pub fn pass(plan: &mut PlanBuilder, image: ImageId) -> ImageId {
    plan.pass(&KERNEL, &[image], &(), Class::Colour, Support::Pixels(0))
}
