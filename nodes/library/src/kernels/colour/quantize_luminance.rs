//! Soft quantization of the lightness of a Lab image (§ 4.6). Bins continue below 0 and above 100, so
//! that highlights beyond white are flattened like everything else.
//!
//! Steps may be left out where the surroundings have no gradient to speak of: there borders of levels would wander,
//! since nothing in the picture says where they are.
//!
//! Cost: one to six reads, a tanh and two square roots per pixel.

pub use crate::kernels::shaders::quantize_luminance::Params;
use crate::kernels::simd::pixels::{Block, for_blocks, write};
use isophote_engine::fearless_simd::{Simd, dispatch, f32x8, prelude::*};
use isophote_engine::math::Elementary;
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance, View};

crate::kernel!(quantize_luminance {
    cpu: run,
    cost: |_| 40.0,
    tolerance: Tolerance {
        absolute: 2e-3,
        relative: 2e-6,
        outliers: 1e-3,
        reason: "phi times half a bin magnifies the rounding of L; a lightness on the border of two \
                 bins may fall on either side",
    },
});

/// How steep the steps are, per unit of L.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Steepness {
    /// The same everywhere.
    Fixed(f32),
    /// From `phi[0]` where the gradient of L (per pixel) is `delta[0]` or less to `phi[1]` where it is
    /// `delta[1]` or more.
    Adaptive {
        /// Gradients.
        delta: [f32; 2],
        /// Steepness.
        phi: [f32; 2],
    },
}

/// Quantizes the L of a Lab image softly to `bins` levels per 100 units:
/// q + d/2 tanh(phi (L - q)), q the middle of the bin of L, d = 100 / `bins`.
pub fn pass(plan: &mut PlanBuilder, lab: ImageId, bins: i32, steepness: Steepness) -> ImageId {
    pass_where(plan, lab, bins, steepness, None)
}

/// Where the steps of [`pass_where`] are.
#[derive(Clone, Copy, Debug)]
pub struct Steps {
    /// The mean gradient of L around each pixel, in the first two of four channels, units of L per pixel.
    pub surroundings: ImageId,
    /// Its length from which on levels step, units of L per pixel; tones below are continuous.
    pub least: f32,
}

/// Narrowest border of two levels, pixels: a narrower one would be jagged.
const CRISPEST: f32 = 1.5;

/// The same, with steps only where the surroundings have something that their borders can follow; borders are then at
/// least 1.5 pixels wide.
pub fn pass_where(
    plan: &mut PlanBuilder,
    lab: ImageId,
    bins: i32,
    steepness: Steepness,
    steps: Option<Steps>,
) -> ImageId {
    let bins = bins.max(1) as f32;
    let mut params = Params {
        width: 100.0 / bins,
        inverse_width: bins / 100.0,
        phi: 0.0,
        adaptive: 0,
        lambda_delta: 0.0,
        inverse_delta: 0.0,
        lambda_phi: 0.0,
        omega_phi: 0.0,
        inverse_least: steps.map_or(0.0, |steps| 1.0 / steps.least.max(1e-6)),
        crispest: CRISPEST,
    };
    match steepness {
        Steepness::Fixed(phi) => params.phi = phi,
        Steepness::Adaptive { delta, phi } => {
            params.adaptive = 1;
            params.lambda_delta = delta[0];
            params.inverse_delta = 1.0 / (delta[1] - delta[0]).max(1e-6);
            [params.lambda_phi, params.omega_phi] = phi;
        }
    }
    let surroundings = steps.map_or(lab, |steps| steps.surroundings);
    plan.pass(&KERNEL, &[lab, surroundings], &params, Class::Colour, Support::Pixels(1))
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    let view = &pass.inputs[0];
    dispatch!(pass.level, simd => for_blocks::<4>(band, #[inline(always)] |block, target| {
        let [l, a, b, alpha] = block.read(simd, view);
        let mut phi = f32x8::splat(simd, params.phi);
        let mut stepped = f32x8::splat(simd, 1.0);
        if params.adaptive != 0 || params.inverse_least > 0.0 {
            let (right, left) =
                (neighbours(simd, view, &block, 1, 0, l), neighbours(simd, view, &block, -1, 0, l));
            let (below, above) =
                (neighbours(simd, view, &block, 0, 1, l), neighbours(simd, view, &block, 0, -1, l));
            let (gx, gy) = ((right - left) * 0.5, (below - above) * 0.5);
            let g = (gx * gx + gy * gy).sqrt();
            if params.adaptive != 0 {
                let t = ((g - params.lambda_delta) * params.inverse_delta).max(0.0).min(1.0);
                phi = t * (params.omega_phi - params.lambda_phi) + params.lambda_phi;
            }
            if params.inverse_least > 0.0 {
                phi = phi.min(f32x8::splat(simd, 2.0) / (g * params.crispest).max(1e-6));
                let [x, y, ..]: [f32x8<_>; 4] = block.read(simd, &pass.inputs[1]);
                let length = (x * x + y * y).sqrt();
                let t = ((length * params.inverse_least - 0.6) * 1.25).max(0.0).min(1.0);
                stepped = t * t * (t * -2.0 + 3.0);
            }
        }
        let middle = ((l * params.inverse_width).floor() + 0.5) * params.width;
        let x = (phi * (l - middle)).max(-20.0).min(20.0);
        let level = middle + x.tanh() * (0.5 * params.width);
        write([l + stepped * (level - l), a, b, alpha], target);
    }));
}

/// Lightness of the neighbours at (dx, dy); where one is not covered, that of the pixel itself.
#[inline(always)]
fn neighbours<S: Simd>(simd: S, view: &View<'_>, block: &Block, dx: i32, dy: i32, own: f32x8<S>) -> f32x8<S> {
    let (x, y) = (block.x + dx, block.y + dy);
    let inside = x >= 0 && x + block.len as i32 <= view.full()[0];
    let [l, alpha] = if inside {
        let [l, _, _, alpha] = Block { x, y, len: block.len }.read(simd, view);
        [l, alpha]
    } else {
        let (mut lightness, mut coverage) = ([0.0; 8], [0.0; 8]);
        for (lane, (l, alpha)) in lightness.iter_mut().zip(&mut coverage).take(block.len).enumerate() {
            [*l, _, _, *alpha] = view.pixel4(x + lane as i32, y);
        }
        [f32x8::simd_from(simd, lightness), f32x8::simd_from(simd, coverage)]
    };
    own + (l - own) * alpha.max(0.0).min(1.0)
}
