//! Shock filters (§ 6.4), step by step.

use crate::declare::spec::{Param, Scope};
use crate::kernels::coherence::directed_shock::{self, Options};
use crate::kernels::coherence::{laplacian, second_derivative, shock_step};
use crate::kernels::smoothing::gaussian_blur;
use isophote_engine::{ImageId, PlanBuilder};

pub(crate) const SIGMA_G: Param = Param::length("sigma_g", "Feature size", 1.5, [0.2, 20.0])
    .slider(0.3, 6.0)
    .hint("Features smaller than this are passed over when edges are sharpened.")
    .doc("Standard deviation of the second derivative along the gradient.");
pub(crate) const SIGMA_I: Param = Param::length("sigma_i", "Pre-smoothing", 0.0, [0.0, 20.0])
    .slider(0.0, 6.0)
    .structural()
    .hint("Smoothing before edges are sharpened, for simpler shapes; 0 for none.")
    .doc("Standard deviation of the Gaussian before the second derivative.");
pub(crate) const RADIUS: Param = Param::length("radius", "Sharpening reach", 2.0, [0.0, 20.0])
    .slider(0.0, 6.0)
    .hint("How wide a soft edge may be to become a sharp one.")
    .doc("How far along the gradient the least or greatest pixel is looked for.");
pub(crate) const THRESHOLD: Param = Param::float("threshold", "Soft below", 0.005, [0.0, 1.0])
    .slider(0.0, 0.05)
    .hint("Changes of lightness that are gentler than this stay soft.").doc(
        "Second derivative, in units of luma, up to which a pixel stays as it is (tau_s): keeps shocks out of \
         smooth parts.",
    );
pub(crate) const ITERATIONS: Param = Param::int("iterations", "Rounds", 3, [1, 100])
    .slider(1.0, 20.0)
    .structural()
    .hint("Steps of the methods that sharpen little by little.")
    .doc("Steps of the two variants that solve an equation.");
pub(crate) const TIME_STEP: Param = Param::float("time_step", "Step size", 0.4, [0.01, 0.5])
    .hint("Strength of each of these steps.")
    .doc("Length of a step of these variants; beyond 1/2 they would not be stable.");

/// The gradient-directed filter; lengths in pixels of the picture that is rendered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Directed {
    pub sigma_g: f32,
    pub sigma_i: f32,
    pub radius: f32,
    /// Pixels per pixel of the full-size picture.
    pub scale: f32,
    pub threshold: f32,
}

impl Directed {
    /// The values of the parameters of a node.
    pub(crate) fn of(scope: &Scope<'_>) -> Self {
        Self {
            sigma_g: scope.float("sigma_g"),
            sigma_i: scope.float("sigma_i"),
            radius: scope.float("radius"),
            scale: scope.scale(),
            threshold: scope.float("threshold"),
        }
    }

    /// Sharpens `color` along the major eigenvectors of `tensor`.
    pub(crate) fn apply(&self, plan: &mut PlanBuilder, color: ImageId, tensor: ImageId) -> ImageId {
        let smooth = smoothed(plan, color, self.sigma_i);
        let options = Options {
            sigma: self.sigma_g,
            radius: self.radius / self.scale,
            scale: self.scale,
            threshold: self.threshold,
        };
        directed_shock::pass(plan, color, tensor, smooth, &options)
    }
}

/// Picture that a second derivative is taken of.
fn smoothed(plan: &mut PlanBuilder, color: ImageId, sigma_i: f32) -> ImageId {
    if sigma_i > 0.0 { gaussian_blur::pass_colour(plan, color, sigma_i) } else { color }
}

/// One step of the classical shock filter (§ 6.4.1).
pub(crate) fn osher_rudin_step(
    plan: &mut PlanBuilder,
    color: ImageId,
    sigma_i: f32,
    time_step: f32,
) -> ImageId {
    let smooth = smoothed(plan, color, sigma_i);
    let detector = laplacian::pass(plan, smooth);
    shock_step::pass(plan, color, detector, time_step)
}

/// One step of the coherence-enhancing shock filter (§ 6.4.2).
pub(crate) fn coherence_enhancing_step(
    plan: &mut PlanBuilder,
    color: ImageId,
    tensor: ImageId,
    sigma_i: f32,
    time_step: f32,
) -> ImageId {
    let smooth = smoothed(plan, color, sigma_i);
    let detector = second_derivative::pass(plan, smooth, tensor);
    shock_step::pass(plan, color, detector, time_step)
}
