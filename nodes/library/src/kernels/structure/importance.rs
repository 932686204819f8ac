//! Importance of places of a picture, 0..=1: as far as structure is clear around them, and near the middle.
//!
//! Cost: an exponential and a division per pixel.

use crate::kernels::shaders::importance::Params;
use crate::kernels::simd::pixels::{for_blocks, write};
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::math::Elementary;
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(importance {
    cpu: |simd, pass, params, band| matter(simd, pass, &params, band),
    cost: |_| 40.0,
    tolerance: Tolerance::of_rounding(
        1e-6,
        4e-6,
        "an exponential, exact to some units in the last place, and a division"
    ),
});

/// Weight of places without structure, and how clear they count.
const EMPTY: f32 = 0.03;
const CLEAR_WHEN_EMPTY: f32 = 0.35;

/// Middle of a picture, and what it counts.
#[derive(Clone, Copy, Debug)]
pub struct Middle {
    /// Middle of the picture, pixels.
    pub at: [f32; 2],
    /// Standard deviation of a Gaussian around it, pixels.
    pub sigma: f32,
    /// Share by which that counts, 0..=1.
    pub share: f32,
}

/// Adds the pass, of (weight share, weight) around each pixel; one channel.
pub fn pass(plan: &mut PlanBuilder, found: ImageId, middle: &Middle) -> ImageId {
    let falloff = -0.5 / (middle.sigma * middle.sigma);
    let params = Params { middle: middle.at, falloff, centre: middle.share };
    plan.pass(&KERNEL, &[found], &params, Class::Field, Support::Pixels(0))
}

#[inline(always)]
fn matter<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, band: &mut Band<'_>) {
    for_blocks::<1>(
        band,
        #[inline(always)]
        |block, target| {
            let [sum, weight, _, _]: [f32x8<S>; 4] = block.read(simd, &pass.inputs[0]);
            let share = (sum + EMPTY * CLEAR_WHEN_EMPTY) / (weight + EMPTY);
            let [x, y] = block.centres(simd);
            let (dx, dy) = (x - params.middle[0], y - params.middle[1]);
            let near = ((dx * dx + dy * dy) * params.falloff).exp();
            write([share.within(0.0, 1.0) * ((near - 1.0) * params.centre + 1.0)], target);
        },
    );
}
