//! Soft quantization of the lightness of a Lab image (§ 4.6). Bins continue below 0 and above 100, so
//! that highlights beyond white are flattened like everything else.
//!
//! Steps may be left out where the surroundings have no gradient to speak of: there borders of levels would wander,
//! since nothing in the picture says where they are.
//!
//! Cost: one to nine reads, a tanh and two square roots per pixel.

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

/// Steepness of the steps, per unit of L.
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

/// Places of the steps of [`pass_where`].
#[derive(Clone, Copy, Debug)]
pub struct Steps {
    /// The mean gradient of L around each pixel, in the first two of four channels, units of L per pixel; one level up.
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
    let mut around = Around::default();
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
                let t = ((g - params.lambda_delta) * params.inverse_delta).within(0.0, 1.0);
                phi = t * (params.omega_phi - params.lambda_phi) + params.lambda_phi;
            }
            if params.inverse_least > 0.0 {
                phi = phi.at_most(f32x8::splat(simd, 2.0) / (g * params.crispest).at_least(1e-6));
                let [x, y] = around.of(simd, &pass.inputs[1], &block);
                let length = (x * x + y * y).sqrt();
                let t = ((length * params.inverse_least - 0.6) * 1.25).within(0.0, 1.0);
                stepped = t * t * (t * -2.0 + 3.0);
            }
        }
        let middle = ((l * params.inverse_width).floor() + 0.5) * params.width;
        let x = (phi * (l - middle)).within(-20.0, 20.0);
        let level = middle + x.tanh() * (0.5 * params.width);
        write([l + stepped * (level - l), a, b, alpha], target);
    }));
}

/// A row of an image one level up between two of its own, in its first two channels.
#[derive(Debug, Default)]
struct Around {
    /// The row of pixels that it stands for; none yet.
    y: Option<i32>,
    /// Column of its first pixel.
    left: i32,
    channels: [Vec<f32>; 2],
}

impl Around {
    /// The image at the pixels of a block, interpolated.
    #[inline(always)]
    fn of<S: Simd>(&mut self, simd: S, view: &View<'_>, block: &Block) -> [f32x8<S>; 2] {
        if self.y != Some(block.y) {
            self.load(view, block.y);
        }
        // Pixel 2 q lies a quarter of the way from pixel q to the one before, pixel 2 q + 1 as far towards the next.
        let first = (block.x >> 1) - self.left;
        let odd = (block.x & 1) as usize;
        self.channels.each_ref().map(
            #[inline(always)]
            |channel| {
                let mut values = [0.0; 10];
                let row = channel[first.max(0) as usize..].windows(3);
                for (pair, near) in values.chunks_exact_mut(2).zip(row) {
                    pair[0] = near[1] + (near[0] - near[1]) * 0.25;
                    pair[1] = near[1] + (near[2] - near[1]) * 0.25;
                }
                f32x8::from_slice(simd, &values[odd..odd + 8])
            },
        )
    }

    /// Loads what lies around row `y`, each with a pixel more on either side.
    fn load(&mut self, view: &View<'_>, y: i32) {
        let (window, height) = (view.window(), view.full()[1]);
        let (near, far) = (y >> 1, (y >> 1) + if y & 1 == 0 { -1 } else { 1 });
        let [near, far] = [near, far].map(|y| view.offset(window.x0, y.clamp(0, height - 1)));
        let len = 4 * window.width() as usize;
        let (near, far) = (&view.data()[near..near + len], &view.data()[far..far + len]);
        (self.y, self.left) = (Some(y), window.x0);
        for (at, channel) in self.channels.iter_mut().enumerate() {
            channel.clear();
            // Beyond the picture lies its edge; beyond the window nothing that is needed.
            let rows =
                || near.iter().zip(far).skip(at).step_by(4).map(|(near, far)| near + (far - near) * 0.25);
            channel.extend(rows().next());
            channel.extend(rows());
            channel.extend(rows().next_back());
        }
    }
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
    own + (l - own) * alpha.within(0.0, 1.0)
}
