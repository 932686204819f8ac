//! Soft quantization of lightness (§ 4.6).

use crate::kernels::colour::quantize_luminance::{self, Steepness};
use crate::kernels::colour::{lab_to_rgb, rgb_to_lab};
use crate::ports;
use crate::spec::{NodeSpec, Param, Scope};
use isophote_engine::ImageId;

/// The node.
pub static NODE: NodeSpec = NodeSpec {
    id: "quantize_luminance",
    label: "Quantize luminance",
    group: "colour",
    doc: "Flattens CIELAB lightness to soft steps, q + d/2 tanh(phi_q (L - q)) with q the middle of the \
          bin of L and d = 100 / bins; colour stays. Bins continue below black and above white.",
    section: "4.6",
    inputs: &[ports::COLOR],
    output: ports::color_output("The flattened picture."),
    own_params: &[
        BINS,
        PHI_Q,
        Param::bool("adaptive", "Adaptive", true).doc(
            "Steepness from the gradient of L instead of `phi_q`: flat parts step softly and flicker less.",
        ),
        LAMBDA_DELTA,
        OMEGA_DELTA,
        LAMBDA_PHI,
        OMEGA_PHI,
    ],
    build,
};

pub(crate) const BINS: Param =
    Param::int("bins", "Bins", 8, [1, 256]).slider(2.0, 24.0).doc("Levels between black and white.");
pub(crate) const PHI_Q: Param = Param::float("phi_q", "Phi q", 3.4, [0.0, 1000.0])
    .slider(0.2, 10.0)
    .doc("Steepness of the steps, per unit of L; counts when not adaptive.");
pub(crate) const LAMBDA_DELTA: Param = Param::float("lambda_delta", "Lambda delta", 0.0, [0.0, 100.0])
    .slider(0.0, 10.0)
    .doc("Gradient of L, per pixel, from which on steps grow steeper.");
pub(crate) const OMEGA_DELTA: Param = Param::float("omega_delta", "Omega delta", 2.0, [0.0, 100.0])
    .slider(0.0, 10.0)
    .doc("Gradient of L, per pixel, at which steps are steepest.");
pub(crate) const LAMBDA_PHI: Param = Param::float("lambda_phi", "Lambda phi", 0.9, [0.0, 1000.0])
    .slider(0.2, 10.0)
    .doc("Steepness in flat parts, per unit of L.");
pub(crate) const OMEGA_PHI: Param = Param::float("omega_phi", "Omega phi", 1.6, [0.0, 1000.0])
    .slider(0.2, 10.0)
    .doc("Steepness at edges, per unit of L.");

/// Steepness as `adaptive` and its parameters say; gradients count per pixel of the full-size picture.
pub(crate) fn steepness(scope: &Scope<'_>, phi_q: f32) -> Steepness {
    if !scope.bool("adaptive") {
        return Steepness::Fixed(phi_q);
    }
    // A proxy's pixel spans 1 / scale pixels of the full picture, and its gradient as many times more.
    let delta = [scope.float("lambda_delta"), scope.float("omega_delta")].map(|d| d / scope.scale());
    Steepness::Adaptive { delta, phi: [scope.float("lambda_phi"), scope.float("omega_phi")] }
}

fn build(scope: &mut Scope<'_>) -> ImageId {
    let color = scope.required("color");
    let (bins, steepness) = (scope.int("bins"), steepness(scope, scope.float("phi_q")));
    let lab = rgb_to_lab::pass(scope.plan, color, 1.0);
    let flat = quantize_luminance::pass(scope.plan, lab, bins, steepness);
    lab_to_rgb::pass(scope.plan, flat, 1.0)
}
