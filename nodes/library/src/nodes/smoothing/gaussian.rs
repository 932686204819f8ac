//! The Gaussian filter (§ 2.2.2, equation 2.21).

use crate::declare::ports;
use crate::declare::spec::{NodeSpec, Param, Scope};
use crate::kernels::smoothing::gaussian_blur;
use isophote_engine::ImageId;

/// The node.
pub static NODE: NodeSpec = NodeSpec {
    id: "gaussian",
    label: "Gaussian blur",
    group: "smoothing",
    hint: "Blurs the picture evenly.",
    doc: "Smooths the picture with a Gaussian (2.21), cut off at three standard deviations and \
          normalised. Transparent pixels lend no colour to their neighbours.",
    section: "2.2.2",
    inputs: &[ports::COLOR],
    output: ports::color_output("The smoothed picture."),
    own_params: &[Param::length("sigma", "Blur", 2.0, [0.0, 80.0])
        .neutral_at_zero()
        .slider(0.0, 20.0)
        .hint("How far the picture is blurred.")
        .doc("Standard deviation of the Gaussian.")],
    build,
};

fn build(scope: &mut Scope<'_>) -> ImageId {
    let (color, sigma) = (scope.required("color"), scope.float("sigma"));
    gaussian_blur::pass_colour(scope.plan, color, sigma)
}
