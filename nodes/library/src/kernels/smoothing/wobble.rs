//! Moves every pixel a little, by smooth noise, so that outlines waver as a hand's do (Bousseau et al.
//! 2006). The noise belongs to the full-size picture, so that tiles and proxies waver alike.
//!
//! Cost: 16 hashes, one bilinear sample and about 150 multiply-adds.

pub use crate::kernels::shaders::wobble::Params;
use crate::kernels::shared::coverage::Covered;
use crate::kernels::shared::sampling::sample_linear4;
use crate::kernels::shared::stream::centres;
use crate::kernels::shared::value_noise::noise;
use crate::kernels::simd::pixels::put_pixels4;
use isophote_engine::fearless_simd::{Simd, dispatch, f32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance, View};

crate::kernel!(wobble {
    cpu: run,
    cost: |_| 320.0,
    tolerance: Tolerance {
        absolute: 1e-3,
        relative: 2e-4,
        outliers: 1e-3,
        reason: "places are a few units in the last place apart, which steep edges magnify",
    },
});

/// Fetches pixels from up to `amount` pixels away; `wavelength` is in pixels of the full-size picture,
/// of which this one is rendered at `scale`.
pub fn waver(plan: &mut PlanBuilder, color: ImageId, amount: f32, wavelength: f32, scale: f32) -> ImageId {
    let params = Params { inverse_scale: 1.0 / scale, amount, frequency: 1.0 / wavelength.max(1.0) };
    plan.pass(&KERNEL, &[color], &params, Class::Colour, Support::Pixels(reach(&params) as u32))
}

/// The most pixels that a sample reads away.
fn reach(params: &Params) -> i32 {
    params.amount.ceil() as i32 + 1
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    let covered = Covered::new(&pass.inputs[0], band, reach(&params));
    let source = covered.view(&pass.inputs[0]);
    dispatch!(pass.level, simd => wavering(simd, &params, &source, band));
}

#[inline(always)]
fn wavering<S: Simd>(simd: S, params: &Params, source: &View<'_>, band: &mut Band<'_>) {
    let window = band.window;
    let zero = f32x8::splat(simd, 0.0);
    for y in window.y0..window.y1 {
        for x in (window.x0..window.x1).step_by(8) {
            let [cx, cy] = centres(simd, x, y, window.x1 - 1);
            let q =
                [cx * params.inverse_scale * params.frequency, cy * params.inverse_scale * params.frequency];
            let (dx, dy) = (offset(simd, q, 3001, params.amount), offset(simd, q, 5003, params.amount));
            let [r, g, b, alpha] = sample_linear4(simd, source, cx + dx, cy + dy);
            let seen = alpha.simd_gt(f32x8::splat(simd, 1e-6));
            let color =
                [seen.select(r / alpha, zero), seen.select(g / alpha, zero), seen.select(b / alpha, zero)];
            let [r, g, b] = color;
            put_pixels4([r, g, b, alpha], &mut band.row_mut(0, y)[4 * (x - window.x0) as usize..]);
        }
    }
}

#[inline(always)]
fn offset<S: Simd>(simd: S, [x, y]: [f32x8<S>; 2], seed: u32, amount: f32) -> f32x8<S> {
    let (coarse, fine) = (noise(simd, x, y, seed), noise(simd, x * 2.7, y * 2.7, seed + 97));
    (coarse * 1.3 + fine * 0.7 - 1.0) * amount
}
