//! Moves every pixel a little, by smooth noise, so that outlines waver as a hand's do (Bousseau et al.
//! 2006). The noise belongs to the full-size picture, so that tiles and proxies waver alike.
//!
//! Cost: 16 hashes, one bilinear sample and about 150 multiply-adds.

pub use crate::kernels::shaders::wobble::Params;
use crate::kernels::shared::coverage::{Covered, unpremultiply};
use crate::kernels::shared::sampling::sample_linear4;
use crate::kernels::shared::value_noise::noise;
use crate::kernels::simd::pixels::{for_blocks, write};
use isophote_engine::fearless_simd::{Simd, dispatch, f32x8};
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

/// Options by which outlines waver.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Distance, pixels of the picture that is rendered.
    pub amount: f32,
    /// Length of the waves, pixels of the full-size picture.
    pub wavelength: f32,
    /// Rendered size over full size.
    pub scale: f32,
    /// Position of the picture in the canonical one, pixels.
    pub origin: [f32; 2],
}

/// Fetches pixels from up to `amount` pixels away; `wavelength` is in pixels of the full-size picture,
/// of which this one is rendered at `scale`.
pub fn pass(plan: &mut PlanBuilder, color: ImageId, options: &Options) -> ImageId {
    let Options { amount, wavelength, scale, origin } = *options;
    let params = Params {
        inverse_scale: 1.0 / scale,
        amount,
        frequency: 1.0 / wavelength.max(1.0),
        origin,
        padding: Default::default(),
    };
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
    for_blocks::<4>(
        band,
        #[inline(always)]
        |block, target| {
            let [cx, cy] = block.centres(simd);
            let (scale, frequency) = (params.inverse_scale, params.frequency);
            let q =
                [(cx + params.origin[0]) * scale * frequency, (cy + params.origin[1]) * scale * frequency];
            let (dx, dy) = (offset(simd, q, 3001, params.amount), offset(simd, q, 5003, params.amount));
            write(unpremultiply(sample_linear4(simd, source, cx + dx, cy + dy)), target);
        },
    );
}

#[inline(always)]
fn offset<S: Simd>(simd: S, [x, y]: [f32x8<S>; 2], seed: u32, amount: f32) -> f32x8<S> {
    let (coarse, fine) = (noise(simd, x, y, seed), noise(simd, x * 2.7, y * 2.7, seed + 97));
    (coarse * 1.3 + fine * 0.7 - 1.0) * amount
}
