//! Motion that is estimated from pictures, where nobody knows it.

use crate::declare::choice::choice;
use crate::declare::ports;
use crate::declare::spec::{ImageKind, NodeSpec, Param, Port, Scope};
use crate::kernels::time::motion_import;
use crate::stages::optical_flow::{Quality, estimate};
use isophote_engine::ImageId;

/// The node.
pub static NODE: NodeSpec = NodeSpec {
    id: "optical_flow",
    label: "Optical flow",
    group: "time",
    hint: "Finds how things move from one frame to the next.",
    doc: "Where the points of a picture are in a neighbouring frame, estimated by dense inverse search with variational \
          refinement (Kroeger et al. 2016). Unknown where there is no such frame.",
    section: "",
    inputs: &[ports::COLOR],
    output: Port {
        id: "motion",
        kind: ImageKind::Motion,
        optional: false,
        doc: "Pixels, x to the right and y down.",
    },
    own_params: &[
        Param::choice("direction", "Direction", Direction::Backward.selected())
            .group("time")
            .hint("Whether motion leads to the frame before, or to the one after.")
            .doc("To the frame before, for `motion`, or to the one after, for `motion_forward`."),
        Param::choice("quality", "Quality", Quality::Medium.selected())
            .group("time")
            .hint("How much care is taken over the motion: more takes longer."),
    ],
    build,
};

choice! {
    /// Frame that the motion leads to.
    enum Direction {
        /// The frame before.
        Backward ("backward", "Backward"),
        /// The frame after.
        Forward ("forward", "Forward"),
    }
}

fn build(scope: &mut Scope<'_>) -> ImageId {
    let towards = match scope.option("direction") {
        Direction::Backward => -1,
        Direction::Forward => 1,
    };
    let here = scope.required("color");
    let is_known = scope.neighbours(1).any(|offset| offset == towards);
    let there = if is_known { scope.at(towards, |scope| scope.input("color")) } else { None };
    let (quality, longest) = (scope.option("quality"), scope.max_motion);
    let motion = estimate(scope.plan, [here, there.unwrap_or(here)], quality, longest);
    // Nothing is as long as no motion at all.
    motion_import::pass(scope.plan, motion, if there.is_some() { longest } else { -1.0 })
}
