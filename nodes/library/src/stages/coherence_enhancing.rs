//! Coherence-enhancing filtering (§ 6): rounds of smoothing along stream lines and of sharpening across them.

use crate::declare::choice::choice;
use crate::declare::spec::{Param, Scope};
use crate::kernels::coherence::carried_tensor;
use crate::kernels::shared::stream::STRETCH;
use crate::kernels::smoothing::line_integral_convolution::{self, Adapt, Options as Lic};
use crate::stages::flow_map::Flow;
use crate::stages::shock::{self, Directed};
use crate::stages::steady::{Agreement, COLOUR_AGREEMENT, compared, steadied, steadied_picture};
use crate::stages::tensor_options::TensorOptions;
use crate::stages::{line_integral_convolution as lic, structure_tensor};
use isophote_engine::{ImageId, PlanBuilder};

pub(crate) const ITERATIONS: Param = Param::int("iterations", "Rounds", 5, [1, 50])
    .slider(1.0, 15.0)
    .structural()
    .hint("Rounds of smoothing and sharpening: more of them draw the picture into simpler, clearer shapes.")
    .doc("Iterations N: the strength of the abstraction.");
pub(crate) const STEPPING: Param = Param::choice("stepping", "Line steps", Stepping::Even.selected()).hint("Whether lines are followed evenly, or in longer steps where they are long: faster, and less smooth.").doc(
    "Steps along stream lines: of one pixel, as the published filter's, or up to 2.5 times as long where lines are, \
     which takes less time and smooths less.",
);
pub(crate) const RHO: Param = Param::length("rho", "Flow scale", 1.0, [0.0, 20.0])
    .slider(0.0, 6.0)
    .structural()
    .hint("Size of the forms that are followed: larger values turn more gently.")
    .doc("Standard deviation of the Gaussian that smooths the structure tensor.");
pub(crate) const RELAX_THRESHOLD: Param = Param::float(
    "relax_threshold",
    "Flow threshold",
    0.0447,
    [0.0, 10.0],
)
.slider(0.0, 0.2)
.structural()
.hint("Where the picture is flatter than this, its direction is taken from around it; 0 trusts every edge.")
.doc(
    "Where sqrt(lambda1) is not above this, the orientation is filled in from around it at first, and \
             from the step before later on (2.7.3); 0 trusts every gradient.",
);
pub(crate) const SIGMA_T: Param = Param::length("sigma_t", "Smoothing length", 6.0, [0.0, 40.0])
    .slider(0.0, 15.0)
    .hint("How far colours are smoothed along lines and edges.")
    .doc("Standard deviation of the smoothing along stream lines (sigma_s of 6.3.1).");
pub(crate) const MAX_ANGLE: Param = Param::float("max_angle", "Largest turn", 22.5, [0.0, 90.0])
    .degrees()
    .hint("Smoothing stops where a line turns by more than this from pixel to pixel; 0 for never.")
    .doc("A stream line ends where it turns by more in one step; 0 for never.");
pub(crate) const ADAPT: Param = Param::choice("adapt", "Shorten lines", Adaption::Anisotropy.selected())
    .uniform()
    .hint("Where smoothing stops early: where directions are uncertain, or where lines turn.")
    .doc("Shortens stream lines where the orientation is uncertain (6.3.1), or as they turn (6.3.2).");
pub(crate) const SHOCK: Param = Param::choice("shock", "Sharpening", Shock::GradientDirected.selected())
.hint("Sharpening after each smoothing: at once, or in small steps that let lines grow together.").doc("What sharpens: the local filter (6.4.3), or three steps of Weickert's equation (6.4.2), which only `sigma_i` controls.");
pub(crate) const SIGMA_A: Param = Param::length("sigma_a", "Edge smoothing", 1.5, [0.0, 20.0])
    .slider(0.0, 5.0)
    .structural()
    .hint("Last smoothing along the edges, against jagged steps; 0 for none.").doc("Standard deviation of the last smoothing along the edges, against the jagged steps of the shocks; 0 for none.");

choice! {
    /// Method by which stream lines are stepped.
    pub(crate) enum Stepping {
        /// In steps of one pixel.
        Even ("even", "Even"),
        /// In fewer and longer ones where lines are long.
        Stretched ("stretched", "Stretched"),
    }
}

choice! {
    /// Measure that shortens the stream lines.
    enum Adaption {
        /// An uncertain direction.
        Anisotropy ("anisotropy", "Where uncertain"),
        /// Turns of the line.
        Angle ("angle", "Where they turn"),
    }
}

choice! {
    /// Filter that sharpens.
    pub(crate) enum Shock {
        /// A filter that sharpens at once.
        GradientDirected ("gradient_directed", "At once"),
        /// Small steps that let lines grow together.
        CoherenceEnhancing ("coherence_enhancing", "Small steps"),
    }
}

/// Options by which a picture is filtered; lengths in pixels of the picture that is rendered.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Filter {
    /// Rounds of smoothing and sharpening.
    pub iterations: i32,
    /// Smoothing of the tensor.
    pub rho: f32,
    /// sqrt(lambda1) that a tensor must exceed to be kept.
    pub relax_threshold: f32,
    /// The smoothing.
    pub smoothing: Lic,
    /// Filter that sharpens.
    pub shock: Shock,
    /// The gradient-directed shock filter.
    pub directed: Directed,
    /// Standard deviation of the last smoothing.
    pub sigma_a: f32,
    /// The orientation in all rounds, instead of that of each round's picture.
    pub given: Option<ImageId>,
    /// Flow that bends the orientation.
    pub flow: Option<Flow>,
}

impl Filter {
    /// The values of the parameters of a node.
    pub(crate) fn of(scope: &mut Scope<'_>) -> Self {
        Self {
            flow: Flow::of(scope),
            iterations: scope.int("iterations"),
            rho: scope.float("rho"),
            relax_threshold: scope.float("relax_threshold"),
            smoothing: Lic {
                sigma: scope.float("sigma_t"),
                adapt: match scope.option("adapt") {
                    Adaption::Anisotropy => Adapt::Anisotropy,
                    Adaption::Angle => Adapt::Angle,
                },
                max_angle: scope.float("max_angle"),
                stretch: match scope.option("stepping") {
                    Stepping::Even => 1.0,
                    Stepping::Stretched => STRETCH,
                },
                ..lic::options()
            },
            shock: scope.option("shock"),
            directed: Directed::of(scope),
            sigma_a: scope.float("sigma_a"),
            given: scope.input("tensor"),
        }
    }

    /// The tensor of `color`; where its gradient is too weak, the field is relaxed at first and taken from
    /// `earlier` later (§ 6.2). One that is given holds throughout.
    fn tensor(&self, plan: &mut PlanBuilder, color: ImageId, earlier: Option<ImageId>) -> ImageId {
        let own = self.given.unwrap_or_else(|| self.own_tensor(plan, color, earlier));
        self.flow.map_or(own, |flow| flow.bend(plan, own))
    }

    fn own_tensor(&self, plan: &mut PlanBuilder, color: ImageId, earlier: Option<ImageId>) -> ImageId {
        match earlier {
            Some(earlier) if self.relax_threshold > 0.0 => {
                carried_tensor::pass(plan, color, earlier, self.rho, self.relax_threshold)
            }
            _ => {
                let options = TensorOptions {
                    rho: self.rho,
                    relax_threshold: self.relax_threshold,
                    ..TensorOptions::default()
                };
                structure_tensor::of_color(plan, color, &options)
            }
        }
    }

    /// Smoothing and sharpening in turn; the picture and the last tensor.
    fn iterate(&self, plan: &mut PlanBuilder, mut color: ImageId) -> (ImageId, Option<ImageId>) {
        let mut tensor = None;
        for _ in 0..self.iterations {
            let along = self.tensor(plan, color, tensor);
            color = line_integral_convolution::pass(plan, color, along, &self.smoothing);
            let mut across = self.tensor(plan, color, Some(along));
            match self.shock {
                Shock::GradientDirected => color = self.directed.apply(plan, color, across),
                // In steps as many and as long as those of the shock filter by itself (§ 6.4.2).
                Shock::CoherenceEnhancing => {
                    for i in 0..shock::ITERATIONS.default_int() {
                        if i > 0 {
                            across = self.tensor(plan, color, Some(across));
                        }
                        let (sigma_i, time_step) = (self.directed.sigma_i, shock::TIME_STEP.default_float());
                        color = shock::coherence_enhancing_step(plan, color, across, sigma_i, time_step);
                    }
                }
            }
            tensor = Some(across);
        }
        (color, tensor)
    }

    /// Smooths the edges along themselves, with lines of full length through every turn (§ 6.5), along the last
    /// tensor.
    pub(crate) fn finish(&self, plan: &mut PlanBuilder, color: ImageId, tensor: Option<ImageId>) -> ImageId {
        match tensor {
            Some(tensor) if self.sigma_a > 0.0 => {
                let last = Lic { sigma: self.sigma_a, ..lic::unadapted() };
                line_integral_convolution::pass_unadapted(plan, color, tensor, &last)
            }
            _ => color,
        }
    }
}

/// The filtered picture and its last tensor, for filters as `filter` reads them from the parameters of a node.
///
/// What every frame comes to by itself is steadied: shocks decide for one side of an edge or the other.
pub(crate) fn filtered(
    scope: &mut Scope<'_>,
    filter: impl Fn(&mut Scope<'_>) -> Filter,
) -> (ImageId, Option<ImageId>) {
    if filter(scope).iterations < 1 {
        return (steadied_picture(scope), None);
    }
    let by = Agreement::rgb(COLOUR_AGREEMENT);
    let [_, filtered, tensor] = steadied(scope, by, |scope| {
        let filter = filter(scope);
        let color = scope.required("color");
        let (filtered, tensor) = filter.iterate(scope.plan, color);
        // Every round has its tensor.
        [compared(scope, color), filtered, tensor.unwrap_or(filtered)]
    });
    (filtered, Some(tensor))
}
