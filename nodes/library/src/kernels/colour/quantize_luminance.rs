//! Soft quantization of the lightness of a Lab image (§ 4.6). Bins continue below 0 and above 100, so
//! that highlights beyond white are flattened like everything else.
//!
//! Cost: one to five reads, a tanh and a square root per pixel.

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
    plan.pass(&KERNEL, &[lab], &params, Class::Colour, Support::Pixels(1))
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    let view = &pass.inputs[0];
    dispatch!(pass.level, simd => for_blocks::<4>(band, #[inline(always)] |block, target| {
        let [l, a, b, alpha] = block.read(simd, view);
        let mut phi = f32x8::splat(simd, params.phi);
        if params.adaptive != 0 {
            let (right, left) =
                (neighbours(simd, view, &block, 1, 0, l), neighbours(simd, view, &block, -1, 0, l));
            let (below, above) =
                (neighbours(simd, view, &block, 0, 1, l), neighbours(simd, view, &block, 0, -1, l));
            let (gx, gy) = ((right - left) * 0.5, (below - above) * 0.5);
            let g = (gx * gx + gy * gy).sqrt();
            let t = ((g - params.lambda_delta) * params.inverse_delta).max(0.0).min(1.0);
            phi = t * (params.omega_phi - params.lambda_phi) + params.lambda_phi;
        }
        let middle = ((l * params.inverse_width).floor() + 0.5) * params.width;
        let x = (phi * (l - middle)).max(-20.0).min(20.0);
        let lightness = middle + x.tanh() * (0.5 * params.width);
        write([lightness, a, b, alpha], target);
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
