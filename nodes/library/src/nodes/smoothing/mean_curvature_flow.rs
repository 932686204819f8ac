//! Mean curvature flow and its constrained variant with shock filtering (§ 6.1), the shape-simplifying
//! abstraction of Kang and Lee.

use crate::declare::ports;
use crate::declare::spec::{NodeSpec, Param, Scope};
use crate::kernels::smoothing::mean_curvature_flow;
use crate::stages::{shock, structure_tensor, tensor_options};
use isophote_engine::ImageId;

/// The node.
pub static NODE: NodeSpec = NodeSpec {
    id: "mean_curvature_flow",
    label: "Mean curvature flow",
    group: "smoothing",
    hint: "Simplifies shapes: small features round off, shrink and vanish.",
    doc: "Simplifies shapes: every isophote moves with its curvature (6.1), so that small features round \
          off, shrink and vanish. The constraint (6.2) protects what follows the local orientation, and \
          shock filtering in between keeps edges sharp. Transparent pixels lend no colour, and coverage \
          stays as it is.",
    section: "6.1",
    inputs: &[ports::COLOR, ports::TENSOR],
    output: ports::color_output("The simplified picture."),
    own_params: &[
        Param::int("iterations", "Rounds", 15, [0, 60]).neutral_at_zero()
            .slider(0.0, 40.0)
            .structural()
            .hint("How often shapes are simplified.").doc("Steps of the flow."),
        Param::float("constraint", "Keep directions", 0.0, [0.0, 1.0]).structural().hint("How far lines that follow the forms of the picture are spared; 1 spares them most.").doc(
            "How much the flow is slowed down where isophotes do not follow the smoothed structure tensor \
             of the input, or one that is connected, r of 6.2: 0 for the free flow, 1 for none across the \
             orientation.",
        ),
        Param::float("time_step", "Step size", 0.25, [0.01, 0.25]).hint("How much is simplified in each round.").doc(
            "Length of a step. Where one of this length would overshoot, pixels go to the mean of their \
             neighbours and no further.",
        ),
        Param::int("shock_every", "Sharpen every", 0, [0, 60])
            .slider(0.0, 15.0)
            .structural()
            .hint("Rounds after which edges are sharpened once; 0 for never.").doc("Sharpening is a step of the classical shock filter (6.3)."),
        tensor_options::RHO.doc("Standard deviation of the Gaussian that smooths the tensor of the constraint, where none is connected."),
    ],
    build,
};

/// Smoothing before the shock filter's Laplacian, pixels of the full-size picture: details smaller than
/// that are left to the flow.
const SHOCK_SIGMA: f32 = 1.0;

fn build(scope: &mut Scope<'_>) -> ImageId {
    let mut color = scope.required("color");
    let (time_step, constraint) = (scope.float("time_step"), scope.float("constraint"));
    let (iterations, shock_every) = (scope.int("iterations"), scope.int("shock_every"));
    let tensors = (constraint > 0.0).then(|| structure_tensor::connected_or_smoothed(scope, color));
    let sigma_i = SHOCK_SIGMA * scope.scale();
    for i in 1..=iterations {
        color = mean_curvature_flow::pass(scope.plan, color, tensors, time_step, constraint);
        if shock_every > 0 && i % shock_every == 0 {
            color = shock::osher_rudin_step(scope.plan, color, sigma_i, shock::TIME_STEP.default_float());
        }
    }
    color
}
