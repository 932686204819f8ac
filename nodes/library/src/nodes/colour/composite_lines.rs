//! Lines over a picture (§ 4.6).

use crate::declare::ports;
use crate::declare::spec::{ImageKind, NodeSpec, Param, Port, Scope};
use crate::kernels::colour::composite_lines::{self, Params};
use isophote_engine::ImageId;

/// The node.
pub static NODE: NodeSpec = NodeSpec {
    id: "composite_lines",
    label: "Composite lines",
    group: "colour",
    hint: "Draws lines over the picture, or over plain paper.",
    doc: "Draws an edge image (1 = paper, 0 = line) over the picture, or over plain paper.",
    section: "4.6",
    inputs: &[
        ports::COLOR,
        Port { id: "edges", kind: ImageKind::Scalar, optional: false, doc: "The edge image." },
    ],
    output: ports::color_output("The picture with lines."),
    own_params: &[
        Param::color("color", "Line colour", [0.0, 0.0, 0.0, 1.0]).hint("Colour of the lines."),
        Param::float("opacity", "Opacity", 1.0, [0.0, 1.0])
            .neutral_at_zero()
            .hint("How opaque the lines are."),
        Param::color("paper", "Paper", [1.0, 1.0, 1.0, 0.0])
            .hint("Paper in place of the picture; its opacity says how much of the picture it covers."),
    ],
    build,
};

fn build(scope: &mut Scope<'_>) -> ImageId {
    let (color, edges) = (scope.required("color"), scope.required("edges"));
    let mut line = scope.color("color");
    line[3] *= scope.float("opacity");
    let paper = scope.color("paper");
    composite_lines::pass(scope.plan, color, edges, &Params { line, paper })
}
