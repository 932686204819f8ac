//! The flow-based bilateral filter (§ 3.5): as the oriented one, with the second pass along stream
//! lines, so that curved features are enhanced and not smoothed away.

use crate::declare::ports;
use crate::declare::spec::{NodeSpec, Scope};
use crate::kernels::colour::{lab_to_rgb, rgb_to_lab};
use crate::kernels::smoothing::{flow_bilateral, oriented_bilateral};
use crate::stages::flow_bilateral::{
    INTEGRATOR, PLACEMENT, Passes, SIGMA_DT, SIGMA_RG, SIGMA_RT, Stepping, iteration,
};
use crate::stages::oriented_bilateral::{ITERATIONS, SAMPLING, SIGMA_DG};
use crate::stages::structure_tensor;
use isophote_engine::ImageId;

/// The node.
pub static NODE: NodeSpec = NodeSpec {
    id: "flow_bilateral",
    label: "Flow bilateral",
    group: "smoothing",
    hint: "Flattens areas of like colour and draws their features out along flowing lines.",
    doc: "Flattens regions and draws features out along their flow: a bilateral filter across the edges \
          and then along the stream lines of the structure tensor (3.10), repeated. Colours are compared \
          in CIELAB. Transparent pixels lend no colour, and coverage stays as it is.",
    section: "3.5",
    inputs: &[ports::COLOR, ports::TENSOR],
    output: ports::color_output("The abstracted picture."),
    own_params: &[SIGMA_DG, SIGMA_DT, SIGMA_RG, SIGMA_RT, ITERATIONS, SAMPLING, INTEGRATOR, PLACEMENT],
    build,
};

fn build(scope: &mut Scope<'_>) -> ImageId {
    let color = scope.required("color");
    let tensors = structure_tensor::connected(scope, color);
    let sampling = scope.option("sampling");
    let passes = Passes {
        gradient: oriented_bilateral::Options {
            sigma_d: scope.float("sigma_dg"),
            sigma_r: scope.float("sigma_rg"),
            sampling,
            elongation: 0.0,
            scaled: false,
        },
        flow: flow_bilateral::Options {
            sigma_d: scope.float("sigma_dt"),
            sigma_r: scope.float("sigma_rt"),
            integrator: scope.option::<Stepping>("integrator").integrator(),
            sampling,
            placement: scope.option("placement"),
        },
    };
    let iterations = scope.int("iterations");
    let mut lab = rgb_to_lab::pass(scope.plan, color, 1.0);
    for _ in 0..iterations {
        lab = iteration(scope.plan, lab, tensors, &passes);
    }
    lab_to_rgb::pass(scope.plan, lab, 1.0)
}
