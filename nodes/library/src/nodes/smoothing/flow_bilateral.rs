//! The flow-based bilateral filter (§ 3.5): as the oriented one, with the second pass along stream
//! lines, so that curved features are enhanced and not smoothed away.
//!
//! Other nodes interleave single iterations with work of their own by `iteration`.

use crate::kernels::colour::{lab_to_rgb, rgb_to_lab};
use crate::kernels::smoothing::flow_bilateral;
use crate::kernels::smoothing::oriented_bilateral::{self, Direction, Sampling};
use crate::nodes::smoothing::oriented_bilateral::{SAMPLING, sampling};
use crate::nodes::structure::structure_tensor;
use crate::ports;
use crate::spec::{Choice, NodeSpec, Param, Scope};
use isophote_engine::{ImageId, PlanBuilder};

/// The node.
pub static NODE: NodeSpec = NodeSpec {
    id: "flow_bilateral",
    label: "Flow Bilateral",
    group: "smoothing",
    doc: "Flattens regions and draws features out along their flow: a bilateral filter across the edges \
          and then along the stream lines of the structure tensor (3.10), repeated. Colours are compared \
          in CIELAB. Transparent pixels lend no colour, and coverage stays as it is.",
    section: "3.5",
    inputs: &[ports::COLOR, ports::TENSOR],
    output: ports::color_output("The abstracted picture."),
    own_params: &[
        Param::float("sigma_dg", "Sigma along gradient", 3.0, [0.0, 40.0])
            .slider(0.0, 10.0)
            .pixels()
            .doc("Standard deviation of the domain weight across edges, cut at 3 sigma."),
        Param::float("sigma_dt", "Sigma along flow", 8.0, [0.0, 40.0])
            .slider(0.0, 20.0)
            .pixels()
            .doc("Standard deviation of the domain weight along stream lines, cut at 2 sigma."),
        Param::float("sigma_rg", "Range across", 2.0, [0.01, 200.0])
            .slider(0.5, 30.0)
            .doc("Standard deviation of the range weight across edges, in CIELAB units."),
        Param::float("sigma_rt", "Range along", 14.0, [0.01, 200.0])
            .slider(0.5, 60.0)
            .doc("Standard deviation of the range weight along stream lines, in CIELAB units."),
        Param::int("iterations", "Iterations", 4, [0, 20])
            .neutral_at_zero()
            .slider(0.0, 10.0)
            .structural()
            .doc("How often both passes run; the orientation is found once."),
        SAMPLING,
        Param::choice(
            "integrator",
            "Integrator",
            1,
            &[Choice { id: "euler", label: "Euler" }, Choice { id: "rk2", label: "Runge-Kutta 2" }],
        )
        .uniform()
        .doc("How lines are stepped: Euler's method (2.177) or the second-order midpoint method (2.182)."),
        Param::choice(
            "placement",
            "Placement",
            1,
            &[
                Choice { id: "equidistant", label: "Equidistant" },
                Choice { id: "pixel_centres", label: "Pixel centres" },
            ],
        )
        .uniform()
        .doc(
            "Where lines are sampled: every pixel of length, or where they cross the centre of a row or \
             column, which blurs less (Listings 3.2 and 3.3).",
        ),
    ],
    build,
};

/// The two passes of an iteration.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Passes {
    /// Across edges, first.
    pub gradient: oriented_bilateral::Options,
    /// Along stream lines, second.
    pub flow: flow_bilateral::Options,
}

impl Default for Passes {
    fn default() -> Self {
        let sampling = Sampling::Linear;
        Self {
            gradient: oriented_bilateral::Options { sigma_d: 3.0, sigma_r: 2.0, sampling, elongation: 0.0 },
            flow: flow_bilateral::Options {
                sigma_d: 8.0,
                sigma_r: 14.0,
                midpoint: true,
                sampling,
                centres: true,
            },
        }
    }
}

/// One iteration on a CIELAB image: across edges, then along stream lines.
pub(crate) fn iteration(plan: &mut PlanBuilder, lab: ImageId, tensors: ImageId, passes: &Passes) -> ImageId {
    let across = oriented_bilateral::pass(plan, lab, tensors, Direction::Gradient, &passes.gradient);
    flow_bilateral::pass(plan, across, tensors, &passes.flow)
}

fn build(scope: &mut Scope<'_>) -> ImageId {
    let color = scope.required("color");
    let tensors = structure_tensor::connected(scope, color);
    let sampling = sampling(scope);
    let passes = Passes {
        gradient: oriented_bilateral::Options {
            sigma_d: scope.float("sigma_dg"),
            sigma_r: scope.float("sigma_rg"),
            sampling,
            elongation: 0.0,
        },
        flow: flow_bilateral::Options {
            sigma_d: scope.float("sigma_dt"),
            sigma_r: scope.float("sigma_rt"),
            midpoint: scope.choice("integrator") == "rk2",
            sampling,
            centres: scope.choice("placement") == "pixel_centres",
        },
    };
    let iterations = scope.int("iterations");
    let mut lab = rgb_to_lab::to_lab(scope.plan, color, 1.0);
    for _ in 0..iterations {
        lab = iteration(scope.plan, lab, tensors, &passes);
    }
    lab_to_rgb::to_rgb(scope.plan, lab, 1.0)
}
