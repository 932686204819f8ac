//! A tensor field as a colour. Orientation: the angle of the tangent, doubled so that opposite
//! directions are one, on a circle of hues whose saturation is the anisotropy; horizontal edges are
//! red, 120 degrees of double angle are green, grey means no orientation. Anisotropy (2.137) as grey.
//!
//! Cost: about 30 operations.

use crate::kernels::support::map_pixels4;
use crate::kernels::tensor_algebra::anisotropy;
use isophote_engine::fearless_simd::{dispatch, f32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::params! {
    /// Uniform block.
    pub struct Params for tensor_display {
        /// 0 orientation, 1 anisotropy.
        pub show: u32,
    }
}

crate::kernel!(tensor_display {
    cpu: run,
    cost: |_| 30.0,
    tolerance: Tolerance { absolute: 2e-6, relative: 0.0, outliers: 0.0, reason: "a division and a dozen roundings of values up to 1" },
});

/// What to show.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Show {
    /// Hue by the double angle of the tangent, saturation by anisotropy.
    Orientation = 0,
    /// Anisotropy as grey.
    Anisotropy = 1,
}

/// Adds the pass: tensor to opaque colour.
pub fn color(plan: &mut PlanBuilder, tensor: ImageId, show: Show) -> ImageId {
    plan.pass(&KERNEL, &[tensor], &Params { show: show as u32 }, Class::Colour, Support::Pixels(0))
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    dispatch!(pass.level, simd => map_pixels4(simd, pass, band, |[e, f, g, _]| {
        let c = |v: f32| f32x8::splat(simd, v);
        if params.show != Show::Orientation as u32 {
            let grey = anisotropy(e, f, g);
            return [grey, grey, grey, c(1.0)];
        }
        // Anisotropy times (cos 2 phi, sin 2 phi), phi the angle of the tangent.
        let trace = (e + g).max(c(f32::MIN_POSITIVE));
        let (x, y) = ((g - e) / trace, f * -2.0 / trace);
        let (across, up) = (x * 0.25, y * 0.433_012_7);
        [x * 0.5 + 0.5, c(0.5) - across + up, c(0.5) - across - up, c(1.0)]
    }));
}
