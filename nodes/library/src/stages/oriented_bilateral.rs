//! One iteration of the orientation-aligned bilateral filter (§ 3.4), on a CIELAB image and with a tensor
//! that stays the same throughout.

use crate::declare::spec::Param;
use crate::kernels::smoothing::oriented_bilateral::{self, Direction, Options, Sampling};
use isophote_engine::{ImageId, PlanBuilder};

pub(crate) const SIGMA_DG: Param = Param::length("sigma_dg", "Reach across", 3.0, [0.0, 40.0])
    .slider(0.0, 10.0)
    .hint("How far colours are smoothed across the edges.")
    .doc("Standard deviation of the domain weight across edges, cut at 3 sigma.");
pub(crate) const SIGMA_DT: Param = Param::length("sigma_dt", "Reach along", 3.0, [0.0, 40.0])
    .slider(0.0, 20.0)
    .hint("How far colours are smoothed along the edges.")
    .doc("Standard deviation of the domain weight along edges, cut at 3 sigma.");
pub(crate) const SIGMA_RG: Param = Param::float("sigma_rg", "Tolerance across", 4.25, [0.01, 200.0])
    .slider(0.5, 30.0)
    .hint("How different colours may be across the edges and still be smoothed into one.")
    .doc("Standard deviation of the range weight across edges, in CIELAB units.");
pub(crate) const SIGMA_RT: Param = Param::float("sigma_rt", "Tolerance along", 4.25, [0.01, 200.0])
    .slider(0.5, 30.0)
    .hint("How different colours may be along the edges and still be smoothed into one.")
    .doc("Standard deviation of the range weight along edges, in CIELAB units.");
/// Number of times that both passes run; the flow-based filter has the same.
pub(crate) const ITERATIONS: Param = Param::int("iterations", "Rounds", 4, [0, 20])
    .neutral_at_zero()
    .slider(0.0, 10.0)
    .structural()
    .hint("How often the picture is smoothed: more rounds give flatter areas.")
    .doc("Times that both passes run; the orientation is found once.");
pub(crate) const ANISOTROPY: Param = Param::float("anisotropy", "Elongation", 0.0, [0.0, 4.0]).hint("How much further it smooths along clear edges than across them; 0 for no further.").doc(
    "Adapts the shape as the ellipse of 5.22 does, with 1/alpha: sigma along the tangent times 1 + elongation \
     A, across it divided by the same, A being the anisotropy. 0 for off.",
);

/// Places where range weights are applied; the flow-based filter has the same choice.
pub(crate) const SAMPLING: Param = Param::choice("sampling", "Colour borders", Sampling::Linear.selected())
    .uniform()
    .hint("Whether borders between colours come out smooth, sharp or jagged.")
    .doc(
        "Linear compares interpolated colours and gives smooth borders; manual compares both pixels before \
         it interpolates (3.9) and gives sharp ones; nearest takes the nearer pixel and gives jagged ones.",
    );

/// The two passes of an iteration.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Passes {
    /// Across edges, first.
    pub gradient: Options,
    /// Along edges, second.
    pub tangent: Options,
}

impl Default for Passes {
    /// The defaults of the parameters.
    fn default() -> Self {
        let pass = |domain: Param, range: Param| Options {
            sigma_d: domain.default_float(),
            sigma_r: range.default_float(),
            sampling: SAMPLING.default_option(),
            elongation: ANISOTROPY.default_float(),
            scaled: false,
        };
        Self { gradient: pass(SIGMA_DG, SIGMA_RG), tangent: pass(SIGMA_DT, SIGMA_RT) }
    }
}

impl Passes {
    /// The same along fields whose fourth channel is a factor on `sigma_r`, where `scaled` says so.
    pub(crate) fn scaled(mut self, scaled: bool) -> Self {
        (self.gradient.scaled, self.tangent.scaled) = (scaled, scaled);
        self
    }
}

/// One iteration on a CIELAB image: across edges, then along them.
pub(crate) fn iteration(plan: &mut PlanBuilder, lab: ImageId, tensors: ImageId, passes: &Passes) -> ImageId {
    let across = oriented_bilateral::pass(plan, lab, tensors, Direction::Gradient, &passes.gradient);
    oriented_bilateral::pass(plan, across, tensors, Direction::Tangent, &passes.tangent)
}
