//! Line integral convolution (§ 2.9) as most nodes want it.

use crate::declare::spec::Param;
use crate::kernels::shared::stream::Integrator;
use crate::kernels::smoothing::line_integral_convolution::{Adapt, Options};

pub(crate) const SIGMA: Param = Param::length("sigma", "Smoothing length", 6.0, [0.0, 40.0])
    .neutral_at_zero()
    .slider(0.0, 20.0)
    .hint("How far the picture is smoothed along its lines and edges.")
    .doc("Standard deviation of the Gaussian along the line, sigma_s of 6.3.1; cut at 2 sigma.");
pub(crate) const ADAPT: Param = Param::choice("adapt", "Shorten lines", Adapt::Anisotropy.selected())
    .uniform()
    .hint("Where smoothing stops early: never, where directions are uncertain, or where lines turn.").doc("Shortens lines where the orientation is uncertain, sigma (1 + A)^2 / 4 (6.3.1), or as they turn (6.3.2).");
pub(crate) const MAX_ANGLE: Param = Param::float("max_angle", "Largest turn", 0.0, [0.0, 90.0])
    .degrees()
    .hint("Smoothing stops where a line turns by more than this from pixel to pixel; 0 for never.")
    .doc("A line ends where it turns by more in one step; 0 for never. 22.5 is the published filter's.");
pub(crate) const STEP: Param = Param::length("step", "Step size", 1.0, [0.25, 4.0])
    .slider(0.25, 2.0)
    .hint("Distance between samples along a line: smaller is more exact and slower.")
    .doc("Step size h of the integration.");

/// Options by which other nodes convolve unless they need something else: the defaults of the parameters, of
/// second order, which long lines need (§ 6.3).
pub fn options() -> Options {
    Options {
        sigma: SIGMA.default_float(),
        step: STEP.default_float(),
        stretch: 1.0,
        integrator: Integrator::TwoStep,
        nearest: false,
        adapt: ADAPT.default_option(),
        max_angle: MAX_ANGLE.default_float(),
    }
}

/// The same for the last smoothing of edges (§ 6.5): without adaption and through every turn.
pub fn unadapted() -> Options {
    Options { adapt: Adapt::None, max_angle: 0.0, ..options() }
}
