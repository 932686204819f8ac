//! Line integral convolution (§ 2.9): smoothing along stream lines of the structure tensor, which
//! makes edges more coherent and gives pictures the look of brush strokes.

use crate::kernels::shared::stream::Integrator;
use crate::kernels::smoothing::cabral_leedom;
use crate::kernels::smoothing::line_integral_convolution::{self, Adapt, Options};
use crate::nodes::structure::structure_tensor;
use crate::ports;
use crate::spec::{Choice, NodeSpec, Param, Scope};
use isophote_engine::ImageId;

/// The node.
pub static NODE: NodeSpec = NodeSpec {
    id: "line_integral_convolution",
    label: "Line Integral Convolution",
    group: "smoothing",
    doc: "Smooths the picture along the edges by following the stream lines of the smoothed structure \
          tensor (2.186): features become coherent, as if painted along, and do not bleed across edges. \
          Lines grow shorter where the orientation is uncertain (6.3.1) or turns (6.3.2).",
    section: "2.9, 6.3",
    inputs: &[
        ports::COLOR,
        ports::TENSOR,
    ],
    output: ports::color_output("The smoothed picture."),
    own_params: &[
        Param::float("sigma", "Sigma", 6.0, [0.0, 40.0]).neutral_at_zero()
            .slider(0.0, 20.0)
            .pixels()
            .doc("Standard deviation of the Gaussian along the line, sigma_s of 6.3.1; cut at 2 sigma."),
        Param::choice(
            "integrator",
            "Integrator",
            1,
            &[
                Choice { id: "euler", label: "Euler" },
                Choice { id: "rk2", label: "Runge-Kutta 2" },
                Choice { id: "cabral_leedom", label: "Cabral-Leedom" },
                Choice { id: "two_step", label: "Two-step midpoint" },
            ],
        )
        .doc(
            "How lines are stepped: Euler's method (2.177), the second-order midpoint method (2.182), \
             from pixel boundary to pixel boundary with the Gaussian integrated exactly on the pixels \
             (Cabral and Leedom, 2.193), where `step` has no part, or the midpoint method with the tangent here \
             foreseen from the last steps, of second order too, which takes less time.",
        ),
        Param::choice(
            "adapt",
            "Adapt length",
            1,
            &[
                Choice { id: "none", label: "Off" },
                Choice { id: "anisotropy", label: "By anisotropy" },
                Choice { id: "angle", label: "By turning angle" },
            ],
        )
        .uniform()
        .doc("Shortens lines where the orientation is uncertain, sigma (1 + A)^2 / 4 (6.3.1), or as they turn (6.3.2)."),
        Param::float("max_angle", "Largest turn", 0.0, [0.0, 90.0])
            .degrees()
            .doc("A line ends where it turns by more in one step; 0 for never. 22.5 is the published filter's."),
        Param::float("step", "Step", 1.0, [0.25, 4.0])
            .slider(0.25, 2.0)
            .pixels()
            .doc("Step size h of the integration."),
    ],
    build,
};

fn build(scope: &mut Scope<'_>) -> ImageId {
    let color = scope.required("color");
    let tensors = structure_tensor::connected(scope, color);
    let options = Options {
        sigma: scope.float("sigma"),
        step: scope.float("step"),
        stretch: 1.0,
        integrator: match scope.choice("integrator") {
            "euler" => Integrator::Euler,
            "two_step" => Integrator::TwoStep,
            _ => Integrator::Midpoint,
        },
        adapt: match scope.choice("adapt") {
            "anisotropy" => Adapt::Anisotropy,
            "angle" => Adapt::Angle,
            _ => Adapt::None,
        },
        max_angle: scope.float("max_angle"),
    };
    if scope.choice("integrator") == "cabral_leedom" {
        return cabral_leedom::color(scope.plan, color, tensors, &options);
    }
    line_integral_convolution::color(scope.plan, color, tensors, &options)
}
