//! The edge tangent flow (§ 2.5): a bilateral filter of tangents, the well-known other way to a smooth
//! orientation field, to compare the structure tensor with.

use crate::declare::ports;
use crate::declare::spec::{ImageKind, NodeSpec, Param, Port, Scope};
use crate::kernels::structure::edge_tangent_flow::{self, Neighbours, Options, Window};
use crate::kernels::structure::gradient_tensor::{self, Derivative, Measure};
use crate::kernels::structure::{flow_maximum, flow_start};
use isophote_engine::ImageId;

/// The node.
pub static NODE: NodeSpec = NodeSpec {
    id: "edge_tangent_flow",
    label: "Edge tangent flow",
    group: "structure",
    hint: "Finds the directions of the picture's edges by averaging them over their surroundings.",
    doc: "Local orientation by Kang's edge tangent flow: the tangents of the colour gradient (optimized \
          3x3 operator) are averaged several times over a neighbourhood (2.134), each by the strength of \
          its gradient against the centre's (2.135) and by how much it agrees with the centre's \
          direction (2.136). Strong edges take weak ones along. The structure tensor is more exact, \
          faster, and knows how certain it is.",
    section: "2.5",
    inputs: &[ports::COLOR],
    output: Port {
        id: "tensor",
        kind: ImageKind::Tensor,
        optional: false,
        doc: "Tensors of rank one and trace 1, whose minor eigenvector is the tangent; w is 0 where there is none.",
    },
    own_params: &[
        Param::length("radius", "Radius", 5.0, [1.0, 20.0])
            .slider(2.0, 12.0)
            .hint("How far around directions are averaged.")
            .doc("Neighbours lie nearer than this."),
        Param::choice("kernel", "Neighbourhood", Window::Box.selected())
            .uniform()
            .hint("Whether all neighbours count alike, or near ones more.")
            .doc("Spatial weight: 1 for all neighbours, or a Gaussian of a third of the radius."),
        Param::int("iterations", "Rounds", 3, [1, 10])
            .structural()
            .hint("How often directions are averaged."),
        Param::bool("separable", "Fast", false)
            .structural()
            .hint("Averages rows and then columns: faster for large radii, and less exact."),
    ],
    build,
};

fn build(scope: &mut Scope<'_>) -> ImageId {
    let color = scope.required("color");
    let radius = scope.float("radius");
    let window = scope.option::<Window>("kernel");
    let neighbours: &[Neighbours] =
        if scope.bool("separable") { &[Neighbours::Row, Neighbours::Column] } else { &[Neighbours::Disc] };
    let iterations = scope.int("iterations");
    let plan = &mut *scope.plan;
    let measure = Measure { scale: 1.0, luma: false, normalize: false, threshold: None };
    let gradients = gradient_tensor::pass(plan, color, Derivative::Scharr3, measure);
    let mut flow = flow_start::pass(plan, gradients);
    let largest = flow_maximum::pass(plan, flow);
    for iteration in 1..=iterations {
        for (index, shape) in neighbours.iter().enumerate() {
            let last = iteration == iterations && index + 1 == neighbours.len();
            flow = edge_tangent_flow::pass(
                plan,
                flow,
                largest,
                &Options { radius, window, neighbours: *shape, last },
            );
        }
    }
    flow
}
