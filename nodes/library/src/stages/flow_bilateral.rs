//! One iteration of the flow-based bilateral filter (§ 3.5), on a CIELAB image.

use crate::declare::choice::choice;
use crate::declare::spec::Param;
use crate::declare::value::Value;
use crate::kernels::shared::stream::Integrator;
use crate::kernels::smoothing::flow_bilateral::{self, Placement};
use crate::kernels::smoothing::oriented_bilateral::{self, Direction};
use crate::stages::oriented_bilateral::{self as across, SAMPLING, SIGMA_DG};
use isophote_engine::{ImageId, PlanBuilder};

pub(crate) const SIGMA_DT: Param = Param::length("sigma_dt", "Reach along", 8.0, [0.0, 40.0])
    .slider(0.0, 20.0)
    .hint("How far colours are smoothed along the flow.")
    .doc("Standard deviation of the domain weight along stream lines, cut at 2 sigma.");
pub(crate) const SIGMA_RG: Param = across::SIGMA_RG.with_default(Value::Float(2.0));
pub(crate) const SIGMA_RT: Param = Param::float("sigma_rt", "Tolerance along", 14.0, [0.01, 200.0])
    .slider(0.5, 60.0)
    .hint("How different colours may be along the flow and still be smoothed into one.")
    .doc("Standard deviation of the range weight along stream lines, in CIELAB units.");
pub(crate) const INTEGRATOR: Param =
    Param::choice("integrator", "Line tracing", Stepping::Midpoint.selected())
        .uniform()
        .hint("How lines are followed: simply, or more exactly.")
        .doc("How lines are stepped: Euler's method (2.177) or the second-order midpoint method (2.182).");
pub(crate) const PLACEMENT: Param = Param::choice(
    "placement",
    "Sampling",
    Placement::PixelCentres.selected(),
)
.uniform()
.hint("Where lines are sampled: at even distances, or at centres of pixels, which blurs less.")
.doc(
    "Where lines are sampled: every pixel of length, or where they cross the centre of a row or column, \
         which blurs less (Listings 3.2 and 3.3).",
);

choice! {
    /// Method by which stream lines are stepped.
    pub(crate) enum Stepping {
        /// Euler's method.
        Euler ("euler", "Simple"),
        /// The midpoint method, a second-order Runge-Kutta method.
        Midpoint ("rk2", "Exact"),
    }
}

impl Stepping {
    /// The method as kernels take it.
    pub(crate) fn integrator(self) -> Integrator {
        match self {
            Self::Euler => Integrator::Euler,
            Self::Midpoint => Integrator::Midpoint,
        }
    }
}

/// The two passes of an iteration.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Passes {
    /// Across edges, first.
    pub gradient: oriented_bilateral::Options,
    /// Along stream lines, second.
    pub flow: flow_bilateral::Options,
}

impl Default for Passes {
    /// The defaults of the parameters.
    fn default() -> Self {
        let sampling = SAMPLING.default_option();
        Self {
            gradient: oriented_bilateral::Options {
                sigma_d: SIGMA_DG.default_float(),
                sigma_r: SIGMA_RG.default_float(),
                sampling,
                elongation: 0.0,
                scaled: false,
            },
            flow: flow_bilateral::Options {
                sigma_d: SIGMA_DT.default_float(),
                sigma_r: SIGMA_RT.default_float(),
                integrator: INTEGRATOR.default_option::<Stepping>().integrator(),
                sampling,
                placement: PLACEMENT.default_option(),
            },
        }
    }
}

/// One iteration on a CIELAB image: across edges, then along stream lines.
pub(crate) fn iteration(plan: &mut PlanBuilder, lab: ImageId, tensors: ImageId, passes: &Passes) -> ImageId {
    let across = oriented_bilateral::pass(plan, lab, tensors, Direction::Gradient, &passes.gradient);
    flow_bilateral::pass(plan, across, tensors, &passes.flow)
}
