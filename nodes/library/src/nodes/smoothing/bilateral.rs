//! The bilateral filter (§ 3.2) and its xy-separable form (§ 3.3).

use crate::declare::choice::choice;
use crate::declare::ports;
use crate::declare::spec::{NodeSpec, Param, Scope};
use crate::kernels::colour::{lab_to_rgb, rgb_to_lab};
use crate::kernels::smoothing::bilateral::Options;
use crate::stages::bilateral::{CUTOFF, Kernel, Passes, iteration};
use isophote_engine::ImageId;

/// The node.
pub static NODE: NodeSpec = NodeSpec {
    id: "bilateral",
    label: "Bilateral",
    group: "smoothing",
    doc: "Flattens regions and keeps edges: a mean of the neighbours, weighted by their distance and by \
          the difference of their colour (3.4), repeated. The separable form is fast and shows \
          artefacts along rows and columns (3.3). Transparent pixels lend no colour, and coverage stays \
          as it is.",
    section: "3.2, 3.3",
    inputs: &[ports::COLOR],
    output: ports::color_output("The abstracted picture."),
    own_params: &[
        Param::choice("kernel", "Kernel", Kernel::Full.selected())
            .doc("The full window (3.2), or rows and then columns (3.3)."),
        Param::length("sigma_d", "Sigma d", 3.0, [0.0, 20.0])
            .slider(0.0, 10.0)
            .doc("Standard deviation of the domain weight."),
        Param::float("sigma_r", "Sigma r", 4.25, [0.01, 200.0])
            .slider(0.5, 30.0)
            .doc("Standard deviation of the range weight, in CIELAB units or in per cent of RGB."),
        Param::int("iterations", "Iterations", 4, [0, 20])
            .neutral_at_zero()
            .slider(0.0, 10.0)
            .structural()
            .doc("How often the filter runs."),
        Param::choice("space", "Colour space", Space::Lab.selected()).doc(
            "Where differences are measured: CIELAB, L in 0..100; or gamma-encoded RGB times 100, so that \
             white lies 173 from black.",
        ),
        CUTOFF,
    ],
    build,
};

choice! {
    /// Space in which differences of colour are measured.
    enum Space {
        /// CIELAB, L in 0..100.
        Lab ("lab", "CIELAB"),
        /// Gamma-encoded RGB.
        Rgb ("rgb", "RGB"),
    }
}

fn build(scope: &mut Scope<'_>) -> ImageId {
    let mut color = scope.required("color");
    let is_lab = scope.option::<Space>("space") == Space::Lab;
    let unit = if is_lab { 1.0 } else { 0.01 };
    let options = Options {
        sigma_d: scope.float("sigma_d"),
        sigma_r: scope.float("sigma_r") * unit,
        cutoff: scope.float("cutoff"),
    };
    let passes = Passes { kernel: scope.option("kernel"), options };
    let iterations = scope.int("iterations");
    if is_lab {
        color = rgb_to_lab::pass(scope.plan, color, 1.0);
    }
    for _ in 0..iterations {
        color = iteration(scope.plan, color, &passes);
    }
    if is_lab { lab_to_rgb::pass(scope.plan, color, 1.0) } else { color }
}
