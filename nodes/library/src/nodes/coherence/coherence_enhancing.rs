//! Coherence-enhancing filtering (§ 6, Fig. 6.3): smoothing along the stream lines of the structure
//! tensor and sharpening across them, in turn. Lines are followed in steps of one pixel, or in fewer that
//! are stretched ([`few_steps`](crate::kernels::shared::stream::few_steps)).

use crate::declare::ports;
use crate::declare::spec::{NodeSpec, STEADINESS, Scope, WINDOW};
use crate::stages::coherence_enhancing::{
    ADAPT, Filter, ITERATIONS, MAX_ANGLE, RELAX_THRESHOLD, RHO, SHOCK, SIGMA_A, SIGMA_T, STEPPING, filtered,
};
use crate::stages::shock;
use isophote_engine::ImageId;

/// The node.
pub static NODE: NodeSpec = NodeSpec {
    id: "coherence_enhancing",
    label: "Coherence filter",
    group: "coherence",
    hint: "Lets hair, branches and folds flow together and keeps small round shapes: smooths along edges and sharpens across them.",
    doc: "Abstraction that makes directional features more coherent and keeps shapes, however small and \
          round: adaptive smoothing along the stream lines of the structure tensor (6.3) and shock \
          filtering across them (6.4), in turn; edges are smoothed along themselves at the end (6.5). \
          Defaults are the thesis'.",
    section: "6",
    inputs: &[ports::COLOR, ports::TENSOR],
    output: ports::color_output("The filtered picture."),
    own_params: &[
        ITERATIONS,
        STEPPING,
        RHO,
        RELAX_THRESHOLD,
        SIGMA_T,
        MAX_ANGLE,
        ADAPT,
        SHOCK,
        shock::SIGMA_G,
        shock::SIGMA_I,
        shock::RADIUS,
        shock::THRESHOLD,
        SIGMA_A,
        STEADINESS,
        WINDOW,
    ],
    build,
};

fn build(scope: &mut Scope<'_>) -> ImageId {
    let (filtered, tensor) = filtered(scope, Filter::of);
    Filter::of(scope).finish(scope.plan, filtered, tensor)
}
