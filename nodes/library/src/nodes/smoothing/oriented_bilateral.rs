//! The orientation-aligned bilateral filter (§ 3.4): regions of like colour become flat, borders stay.

use crate::declare::ports;
use crate::declare::spec::{NodeSpec, STEADINESS, Scope, WINDOW};
use crate::kernels::colour::{lab_to_rgb, rgb_to_lab};
use crate::kernels::smoothing::oriented_bilateral::Options;
use crate::stages::oriented_bilateral::{
    ANISOTROPY, ITERATIONS, Passes, SAMPLING, SIGMA_DG, SIGMA_DT, SIGMA_RG, SIGMA_RT, iteration,
};
use crate::stages::steady::steadied_picture;
use crate::stages::structure_tensor;
use isophote_engine::ImageId;

/// The node.
pub static NODE: NodeSpec = NodeSpec {
    id: "oriented_bilateral",
    label: "Oriented bilateral",
    group: "smoothing",
    hint: "Flattens areas of like colour along the edges and keeps their borders clean.",
    doc: "Flattens regions of like colour and keeps their borders: a bilateral filter in two passes, \
          along the gradient and then along the tangent of the local structure (Listing 3.1), \
          repeated. Colours are compared in CIELAB. Transparent pixels lend no colour, and coverage \
          stays as it is.",
    section: "3.4",
    inputs: &[ports::COLOR, ports::TENSOR],
    output: ports::color_output("The abstracted picture."),
    own_params: &[
        SIGMA_DG, SIGMA_DT, SIGMA_RG, SIGMA_RT, ITERATIONS, SAMPLING, ANISOTROPY, STEADINESS, WINDOW,
    ],
    build,
};

fn build(scope: &mut Scope<'_>) -> ImageId {
    let color = steadied_picture(scope);
    let tensors = structure_tensor::connected(scope, color);
    let options = |domain, range| Options {
        sigma_d: scope.float(domain),
        sigma_r: scope.float(range),
        sampling: scope.option("sampling"),
        elongation: scope.float("anisotropy"),
        scaled: false,
    };
    let passes =
        Passes { gradient: options("sigma_dg", "sigma_rg"), tangent: options("sigma_dt", "sigma_rt") };
    let iterations = scope.int("iterations");
    let mut lab = rgb_to_lab::pass(scope.plan, color, 1.0);
    for _ in 0..iterations {
        lab = iteration(scope.plan, lab, tensors, &passes);
    }
    lab_to_rgb::pass(scope.plan, lab, 1.0)
}
