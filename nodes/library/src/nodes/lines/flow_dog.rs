//! The flow-based difference of Gaussians filter, separable (§ 4.5), with lines where geometry breaks.

use crate::kernels::colour::lightness;
use crate::kernels::edge_threshold::{Threshold, Xdog};
use crate::kernels::lines::{darken_by_lines, flow_dog_gradient, flow_dog_tangent, guide_lines, orientation_field};
use crate::nodes::lines::difference_of_gaussians as dog;
use crate::nodes::structure::structure_tensor::{Guides, TensorOptions, of_color_and_guides};
use crate::ports;
use crate::spec::{Choice, ImageKind, NodeSpec, Param, Port, Scope};
use isophote_engine::{ImageId, PlanBuilder};

/// The node.
pub static NODE: NodeSpec = NodeSpec {
    id: "flow_dog",
    label: "Flow-based difference of Gaussians",
    group: "lines",
    doc: "Coherent lines: a difference of Gaussians across the edges, smoothed along them (Listing 4.1). \
          Where normals, depth or object ids are given and `guide_weight` is above 0, lines are also \
          drawn where these break, along the same flow. 1 is paper, 0 is line.",
    section: "4.5",
    inputs: &[
        ports::COLOR,
        ports::TENSOR,
        NORMAL,
        DEPTH,
        OBJECT_ID,
    ],
    output: dog::EDGES,
    own_params: &[
        dog::SIGMA_E,
        dog::K,
        SIGMA_M,
        dog::FORM,
        dog::TAU,
        dog::EPSILON,
        dog::PHI,
        dog::P,
        dog::EPSILON_P,
        dog::PHI_P,
        dog::THRESHOLD,
        Param::int("iterations", "Iterations", 1, [1, 16])
            .slider(1.0, 5.0)
            .structural()
            .doc("Times the filter runs, each on the lightness times the lines found so far, which closes gaps."),
        Param::choice("kernel", "Kernel", 0, &[Choice { id: "separable", label: "Separable" }])
            .uniform()
            .doc("Separable: across the tangent at each pixel, then along its stream line."),
        INTEGRATOR,
        Param::float("guide_weight", "Guide weight", 0.0, [0.0, 16.0])
            .slider(0.0, 2.0)
            .structural()
            .doc("Strength of lines where normal, depth or object id break; 0 leaves the guides unread."),
    ],
    build,
};

pub(crate) const NORMAL: Port =
    Port { id: "normal", kind: ImageKind::Normal, optional: true, doc: "View-space normals; creases draw lines." };
pub(crate) const DEPTH: Port = Port {
    id: "depth",
    kind: ImageKind::Depth,
    optional: true,
    doc: "Distance from the camera; jumps draw lines, relative to the distance and never on planes.",
};
pub(crate) const OBJECT_ID: Port = Port {
    id: "object_id",
    kind: ImageKind::ObjectId,
    optional: true,
    doc: "Object numbers; borders between objects draw lines.",
};
pub(crate) const SIGMA_M: Param = Param::float("sigma_m", "Sigma m", 3.0, [0.0, 60.0])
    .slider(0.0, 15.0)
    .pixels()
    .doc("Standard deviation of the smoothing along the edges; longer lines and less noise.");
pub(crate) const INTEGRATOR: Param = Param::choice(
    "integrator",
    "Integrator",
    1,
    &[
        Choice { id: "euler", label: "Euler" },
        Choice { id: "rk2", label: "Runge-Kutta, second order" },
    ],
)
.uniform()
.doc("How stream lines are stepped: Euler (2.176) or second order (2.182).");

/// How lines are drawn along the flow; lengths in pixels of the picture that is rendered.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FlowDog {
    pub sigma_e: f32,
    pub k: f32,
    pub sigma_m: f32,
    pub xdog: Xdog,
    pub iterations: i32,
    pub midpoint: bool,
    pub guide_weight: f32,
}

impl FlowDog {
    /// The edge image of (L alpha, alpha) along the stream lines of `tensor`.
    pub(crate) fn edges(
        &self,
        plan: &mut PlanBuilder,
        lightness: ImageId,
        tensor: ImageId,
        guides: &Guides,
    ) -> ImageId {
        let field = orientation_field::of_tensor(plan, tensor);
        let (mut source, mut edges) = (lightness, lightness);
        let guides = [guides.normal, guides.depth, guides.object_id];
        for iteration in 1..=self.iterations {
            let last = iteration == self.iterations;
            let mut response =
                flow_dog_gradient::response(plan, source, field, self.sigma_e, self.k, &self.xdog);
            if self.guide_weight > 0.0 && guides.iter().any(Option::is_some) {
                let (sigma, weight) = (self.sigma_e, self.guide_weight);
                response =
                    guide_lines::add(plan, response, field, guides, sigma, weight, self.xdog.edge);
            }
            let mut xdog = self.xdog;
            if !last && xdog.threshold == Threshold::None {
                // Only an edge image can darken the input of the next iteration.
                xdog.threshold = Threshold::Tanh;
            }
            edges = flow_dog_tangent::edges(plan, response, field, self.sigma_m, self.midpoint, &xdog);
            if !last {
                source = darken_by_lines::darken(plan, lightness, edges);
            }
        }
        edges
    }
}

/// The guides connected to a node, as far as `weight` lets them count.
pub(crate) fn guides(scope: &Scope<'_>, weight: f32) -> Guides {
    if weight <= 0.0 {
        return Guides::default();
    }
    Guides {
        normal: scope.input("normal"),
        depth: scope.input("depth"),
        object_id: scope.input("object_id"),
    }
}

/// The tensor of a picture and of the guides that count, for a node without a connected one.
pub(crate) fn tensor(scope: &mut Scope<'_>, color: ImageId, guides: &Guides) -> ImageId {
    let options = TensorOptions::at_scale(scope.scale());
    of_color_and_guides(scope.plan, color, guides, &options)
}

fn build(scope: &mut Scope<'_>) -> ImageId {
    let color = scope.required("color");
    let lines = FlowDog {
        sigma_e: scope.float("sigma_e"),
        k: scope.float("k"),
        sigma_m: scope.float("sigma_m"),
        xdog: dog::xdog(scope),
        iterations: scope.int("iterations"),
        midpoint: scope.choice("integrator") == "rk2",
        guide_weight: scope.float("guide_weight"),
    };
    let guides = guides(scope, lines.guide_weight);
    let tensor = match scope.input("tensor") {
        Some(tensor) => tensor,
        None => tensor(scope, color, &guides),
    };
    let lightness = lightness::of_color(scope.plan, color);
    lines.edges(scope.plan, lightness, tensor, &guides)
}
