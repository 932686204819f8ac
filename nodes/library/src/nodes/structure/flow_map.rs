//! Flow maps: orientation that an artist painted (§ 1.2), as game engines have it.

use crate::declare::ports;
use crate::declare::spec::{ImageKind, NodeSpec, Port, Scope};
use crate::stages::flow_map::{Flow, INVERT_Y, SOFTNESS, STRENGTH};
use isophote_engine::ImageId;

/// The node.
pub static NODE: NodeSpec = NodeSpec {
    id: "flow_map",
    label: "Flow map",
    group: "structure",
    hint: "Bends the directions that strokes and lines follow to what an artist painted.",
    doc: "Bends a tensor field to what an artist painted: red and green are the x and y of a direction, 0.5 for \
          none, and alpha is its strength. Which way a direction points does not matter. Where nothing is painted \
          the field stays as it is.",
    section: "1.2",
    inputs: &[
        Port {
            id: "color",
            kind: ImageKind::Color,
            optional: false,
            doc: "The flow map; the graph's input `flow` enters without any change of colour space.",
        },
        Port {
            doc: "The field to bend; when open, nothing but the painted directions counts.",
            ..ports::TENSOR
        },
    ],
    output: Port { id: "tensor", kind: ImageKind::Tensor, optional: false, doc: "The bent field." },
    own_params: &[STRENGTH, SOFTNESS, INVERT_Y],
    build,
};

fn build(scope: &mut Scope<'_>) -> ImageId {
    let map = scope.required("color");
    let (strength, softness) = (scope.float("strength"), scope.float("softness"));
    let flow = Flow::new(scope.plan, map, strength, softness, scope.bool("invert_y"));
    match scope.input("tensor") {
        Some(tensor) => flow.bend(scope.plan, tensor),
        None => flow.0,
    }
}
