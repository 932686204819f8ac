//! Raises or lowers the dark and the light tones of a Lab image; black, white and what lies beyond
//! them stay.
//!
//! Cost: ten multiply-adds per pixel.

pub use crate::kernels::shaders::tone_curve::Params;
use crate::kernels::simd::pixels::map_pixels;
use isophote_engine::fearless_simd::{dispatch, f32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(tone_curve {
    cpu: run,
    cost: |_| 10.0,
    tolerance: Tolerance::of_rounding(5e-5, 1e-6, "ten roundings of L"),
});

/// L + 90 t (1 - t) (`darks` (1 - t) + `lights` t), t = L / 100 clamped to 0..=1: monotonic for
/// arguments in -1..=1, since the slope is at least 0.1 everywhere.
pub fn pass(plan: &mut PlanBuilder, lab: ImageId, params: &Params) -> ImageId {
    plan.pass(&KERNEL, &[lab], params, Class::Colour, Support::Pixels(0))
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    dispatch!(pass.level, simd => map_pixels(simd, pass, band, #[inline(always)] |[l, a, b, alpha]| {
        let t = (l * 0.01).within(0.0, 1.0);
        let rest = f32x8::splat(simd, 1.0) - t;
        let lift = t * rest * 90.0 * (rest * params.darks + t * params.lights);
        [l + lift, a, b, alpha]
    }));
}

#[cfg(test)]
mod tests {
    /// The curve in double precision.
    fn curve(t: f64, darks: f64, lights: f64) -> f64 {
        t + 0.9 * t * (1.0 - t) * (darks * (1.0 - t) + lights * t)
    }

    #[test]
    fn tones_keep_their_order_at_every_setting() {
        for darks in [-1.0, -0.5, 0.0, 0.5, 1.0] {
            for lights in [-1.0, -0.5, 0.0, 0.5, 1.0] {
                let steps = (1..=1000).map(|i| f64::from(i) / 1000.0);
                let slope = steps
                    .map(|t| (curve(t, darks, lights) - curve(t - 1e-3, darks, lights)) * 1e3)
                    .fold(f64::MAX, f64::min);
                assert!(slope > 0.09, "slope {slope} at darks {darks}, lights {lights}");
            }
        }
    }
}
