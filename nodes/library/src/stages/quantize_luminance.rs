//! Soft quantization of lightness (§ 4.6).

use crate::declare::spec::{Param, Scope};
use crate::kernels::colour::quantize_luminance::{self, Steepness, Steps};
use crate::kernels::colour::tone_gradient;
use crate::kernels::smoothing::gaussian_blur;
use isophote_engine::{Class, ImageId};

pub(crate) const BINS: Param = Param::int("bins", "Tones", 8, [1, 256])
    .slider(2.0, 24.0)
    .hint("Number of tones from black to white.")
    .doc("Bins between black and white.");
pub(crate) const ADAPTIVE: Param = Param::bool("adaptive", "Adaptive steps", true)
    .hint("Softer steps in flat areas and steeper ones at edges, so that moving pictures flicker less.")
    .doc("Steepness from the gradient of L instead of `phi_q`. Counts where steps are by lightness.");
pub(crate) const PHI_Q: Param = Param::float("phi_q", "Step steepness", 3.4, [0.0, 1000.0])
    .slider(0.2, 10.0)
    .hint("How suddenly one tone changes to the next. Does not count with adaptive steps.")
    .doc("Steepness of the steps, per unit of L.");
pub(crate) const LAMBDA_DELTA: Param = Param::float("lambda_delta", "Softest below", 0.0, [0.0, 100.0])
    .slider(0.0, 10.0)
    .hint("Contrast below which adaptive steps are softest.")
    .doc("Gradient of L, per pixel, from which on steps grow steeper.");
pub(crate) const OMEGA_DELTA: Param = Param::float("omega_delta", "Steepest above", 2.0, [0.0, 100.0])
    .slider(0.0, 10.0)
    .hint("Contrast above which adaptive steps are steepest.")
    .doc("Gradient of L, per pixel, at which steps are steepest.");
pub(crate) const LAMBDA_PHI: Param = Param::float("lambda_phi", "Flat steepness", 0.9, [0.0, 1000.0])
    .slider(0.2, 10.0)
    .hint("How sudden adaptive steps are in flat areas.")
    .doc("Steepness in flat parts, per unit of L.");
pub(crate) const OMEGA_PHI: Param = Param::float("omega_phi", "Edge steepness", 1.6, [0.0, 1000.0])
    .slider(0.2, 10.0)
    .hint("How sudden adaptive steps are at edges.")
    .doc("Steepness at edges, per unit of L.");
pub(crate) const LEAST_GRADIENT: Param =
    Param::float("least_gradient", "Smooth below", 0.0, [0.0, 1.0]).slider(0.0, 0.5).structural().hint("Tones stay smooth where the picture changes less than this; 0 makes steps everywhere.").doc(
        "Gradient of L, per pixel, that the surroundings have where levels step; where they have less, tones are \
         continuous, since borders of levels would follow nothing there. 0 steps everywhere.",
    );

/// Steepness as `adaptive` and its parameters say; gradients count per pixel of the full-size picture.
fn steepness(scope: &Scope<'_>, phi_q: f32) -> Steepness {
    if !scope.bool("adaptive") {
        return Steepness::Fixed(phi_q);
    }
    // A proxy's pixel spans 1 / scale pixels of the full picture, and its gradient as many times more.
    let delta = [scope.float("lambda_delta"), scope.float("omega_delta")].map(|d| d / scope.scale());
    Steepness::Adaptive { delta, phi: [scope.float("lambda_phi"), scope.float("omega_phi")] }
}

/// Longest gradient that counts in full, L per pixel: edges must not bring steps into all that lies beside them.
const LONGEST: f32 = 1.0;

/// Standard deviation of the surroundings whose gradient counts, pixels of the full-size picture.
const SURROUNDINGS: f32 = 5.0;

/// The flattened Lab image, with steps where `least_gradient` says.
pub(crate) fn flattened(scope: &mut Scope<'_>, lab: ImageId, bins: i32, phi_q: f32) -> ImageId {
    let steepness = steepness(scope, phi_q);
    let least = scope.float("least_gradient");
    stepped(scope, lab, bins, steepness, least)
}

/// The flattened Lab image, with steps where the surroundings change by `least` L per pixel of the full-size picture.
pub(crate) fn stepped(
    scope: &mut Scope<'_>,
    lab: ImageId,
    bins: i32,
    steepness: Steepness,
    least: f32,
) -> ImageId {
    let scale = scope.scale();
    let steps = (least > 0.0).then(|| {
        let gradient = tone_gradient::pass(scope.plan, lab, LONGEST / scale);
        // It lies one level up.
        let surroundings =
            gaussian_blur::pass(scope.plan, gradient, 0.5 * SURROUNDINGS * scale, Class::Colour);
        Steps { surroundings, least: least / scale }
    });
    quantize_luminance::pass_where(scope.plan, lab, bins, steepness, steps)
}
