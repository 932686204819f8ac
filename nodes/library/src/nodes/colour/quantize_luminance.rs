//! Soft quantization of lightness (§ 4.6).

use crate::declare::ports;
use crate::declare::spec::{NodeSpec, Scope};
use crate::kernels::colour::{lab_to_rgb, rgb_to_lab};
use crate::stages::quantization::{STEPS, flattened};
use crate::stages::quantize_luminance::{
    ADAPTIVE, BINS, LAMBDA_DELTA, LAMBDA_PHI, LEAST_GRADIENT, OMEGA_DELTA, OMEGA_PHI, PHI_Q,
};
use isophote_engine::ImageId;

/// The node.
pub static NODE: NodeSpec = NodeSpec {
    id: "quantize_luminance",
    label: "Posterize",
    group: "colour",
    hint: "Flattens lightness to a few soft steps and keeps the colours.",
    doc: "Flattens CIELAB lightness to soft steps, q + d/2 tanh(phi_q (L - q)) with q the middle of the \
          bin of L and d = 100 / bins; colour stays. Bins continue below black and above white.",
    section: "4.6",
    inputs: &[ports::COLOR],
    output: ports::color_output("The flattened picture."),
    own_params: &[
        BINS,
        PHI_Q,
        ADAPTIVE,
        LAMBDA_DELTA,
        OMEGA_DELTA,
        LAMBDA_PHI,
        OMEGA_PHI,
        LEAST_GRADIENT,
        STEPS,
    ],
    build,
};

fn build(scope: &mut Scope<'_>) -> ImageId {
    let color = scope.required("color");
    let bins = scope.int("bins");
    let lab = rgb_to_lab::pass(scope.plan, color, 1.0);
    let flat = flattened(scope, lab, bins, scope.float("phi_q"));
    lab_to_rgb::pass(scope.plan, flat, 1.0)
}
