//! Morphological filters with a disc (§ 5.1).
//!
//! Dilation and erosion are those of each channel of gamma-encoded RGB. Only so are opening and closing
//! dual under inversion of the picture, which § 5.1 relies on, and idempotent; an order by lightness
//! would keep the colours of single pixels but tear channels' contours apart where colours are equally
//! light.

use crate::declare::choice::choice;
use crate::declare::ports;
use crate::declare::spec::{NodeSpec, Param, Scope};
use crate::kernels::smoothing::disc_extremum::{self, Extremum};
use crate::stages::morphology::{close, open};
use isophote_engine::ImageId;

/// The node.
pub static NODE: NodeSpec = NodeSpec {
    id: "morphology",
    label: "Morphology",
    group: "smoothing",
    hint: "Removes small light or dark spots, or widens light or dark areas.",
    doc: "Greatest and least values within a disc, channel by channel. Opening removes light features \
          smaller than the disc, closing dark ones; one after the other they smooth the picture. Closing \
          first gives the lighter result that suits watercolour. Transparent pixels lend no colour, and \
          coverage stays as it is.",
    section: "5.1",
    inputs: &[ports::COLOR],
    output: ports::color_output("The filtered picture."),
    own_params: &[
        Param::choice("operator", "Operation", Operator::OpenClose.selected())
            .hint("Widens light or dark areas, or removes small light or dark spots.")
            .doc("Dilation and erosion, opening (erosion, then dilation), closing (the reverse), or both."),
        Param::length("radius", "Radius", 3.0, [0.0, 30.0])
            .neutral_at_zero()
            .slider(0.0, 12.0)
            .hint("Size of the spots that go, or how far areas are widened.")
            .doc("Radius of the disc; its pixels are those with x^2 + y^2 <= radius (radius + 1)."),
    ],
    build,
};

choice! {
    /// The morphological operator.
    enum Operator {
        /// Dilation: the greatest value.
        Dilate ("dilate", "Widen lights"),
        /// Erosion: the least value.
        Erode ("erode", "Widen darks"),
        /// Opening: erosion, then dilation.
        Open ("open", "Remove lights"),
        /// Closing: dilation, then erosion.
        Close ("close", "Remove darks"),
        /// Opening, then closing.
        OpenClose ("open_close", "Lights, then darks"),
        /// Closing, then opening.
        CloseOpen ("close_open", "Darks, then lights"),
    }
}

fn build(scope: &mut Scope<'_>) -> ImageId {
    let (color, radius) = (scope.required("color"), scope.float("radius"));
    let operator = scope.option("operator");
    let plan = &mut *scope.plan;
    match operator {
        Operator::Dilate => disc_extremum::pass(plan, color, radius, Extremum::Greatest),
        Operator::Erode => disc_extremum::pass(plan, color, radius, Extremum::Least),
        Operator::Open => open(plan, color, radius),
        Operator::Close => close(plan, color, radius),
        Operator::OpenClose => {
            let opened = open(plan, color, radius);
            close(plan, opened, radius)
        }
        Operator::CloseOpen => {
            let closed = close(plan, color, radius);
            open(plan, closed, radius)
        }
    }
}
