//! Line integral convolution (§ 2.9): smoothing along stream lines of the structure tensor, which
//! makes edges more coherent and gives pictures the look of brush strokes.

use crate::declare::choice::choice;
use crate::declare::ports;
use crate::declare::spec::{NodeSpec, Param, Scope};
use crate::kernels::shared::stream::Integrator;
use crate::kernels::smoothing::cabral_leedom;
use crate::kernels::smoothing::line_integral_convolution::{self, Options};
pub use crate::stages::line_integral_convolution::options;
use crate::stages::line_integral_convolution::{ADAPT, MAX_ANGLE, SIGMA, STEP};
use crate::stages::structure_tensor;
use isophote_engine::ImageId;

/// The node.
pub static NODE: NodeSpec = NodeSpec {
    id: "line_integral_convolution",
    label: "Flow blur",
    group: "smoothing",
    hint: "Blurs the picture along its edges, as if painted along them, and never across.",
    doc: "Smooths the picture along the edges by following the stream lines of the smoothed structure \
          tensor (2.186): features become coherent, as if painted along, and do not bleed across edges. \
          Lines grow shorter where the orientation is uncertain (6.3.1) or turns (6.3.2).",
    section: "2.9, 6.3",
    inputs: &[ports::COLOR, ports::TENSOR],
    output: ports::color_output("The smoothed picture."),
    own_params: &[SIGMA, INTEGRATOR, SAMPLING, ADAPT, MAX_ANGLE, STEP],
    build,
};

const INTEGRATOR: Param = Param::choice("integrator", "Line tracing", Stepping::Midpoint.selected()).hint("How lines are followed: simply, exactly, pixel by pixel, or exactly and faster.").doc(
    "How lines are stepped: Euler's method (2.177), the second-order midpoint method (2.182), from pixel \
     boundary to pixel boundary with the Gaussian integrated exactly on the pixels (Cabral and Leedom, 2.193), \
     where `step` has no part, or the midpoint method with the tangent here extrapolated from the last steps, of \
     second order too, which takes less time.",
);
const SAMPLING: Param = Param::choice("sampling", "Direction sampling", Sampling::Linear.selected()).uniform().hint("Whether directions between pixels are blended, or taken from the nearest: faster, and rougher.").doc(
    "What a line follows between pixels: the tensor interpolated bilinearly, or that of the nearest pixel, which takes \
     less and gives rougher lines (2.9.2); Cabral and Leedom's method always takes the pixel's own.",
);

choice! {
    /// Tensor that a line follows between pixels.
    enum Sampling {
        /// Blended between pixels.
        Linear ("linear", "Blended"),
        /// Taken from the nearest pixel.
        Nearest ("nearest", "Nearest"),
    }
}

choice! {
    /// Method by which stream lines are stepped.
    enum Stepping {
        /// Euler's method.
        Euler ("euler", "Simple"),
        /// The midpoint method, a second-order Runge-Kutta method.
        Midpoint ("rk2", "Exact"),
        /// From pixel boundary to pixel boundary, the method of Cabral and Leedom.
        CabralLeedom ("cabral_leedom", "Pixel by pixel"),
        /// The midpoint method with an extrapolated tangent, as exact and faster.
        TwoStep ("two_step", "Exact, faster"),
    }
}

fn build(scope: &mut Scope<'_>) -> ImageId {
    let color = scope.required("color");
    let tensors = structure_tensor::connected(scope, color);
    let mut options = Options {
        sigma: scope.float("sigma"),
        step: scope.float("step"),
        nearest: scope.option::<Sampling>("sampling") == Sampling::Nearest,
        adapt: scope.option("adapt"),
        max_angle: scope.float("max_angle"),
        ..options()
    };
    options.integrator = match scope.option("integrator") {
        Stepping::Euler => Integrator::Euler,
        Stepping::Midpoint => Integrator::Midpoint,
        Stepping::TwoStep => Integrator::TwoStep,
        Stepping::CabralLeedom => return cabral_leedom::pass(scope.plan, color, tensors, &options),
    };
    line_integral_convolution::pass(scope.plan, color, tensors, &options)
}
