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
    hint: "Flattens areas of like colour and keeps the edges between them.",
    doc: "Flattens regions and keeps edges: a mean of the neighbours, weighted by their distance and by \
          the difference of their colour (3.4), repeated. The separable form is fast and shows \
          artefacts along rows and columns (3.3). Transparent pixels lend no colour, and coverage stays \
          as it is.",
    section: "3.2, 3.3",
    inputs: &[ports::COLOR],
    output: ports::color_output("The abstracted picture."),
    own_params: &[
        Param::choice("kernel", "Neighbourhood", Kernel::Full.selected())
            .hint("Whether all directions are smoothed at once, or rows and then columns, which is faster and less clean.").doc("The full window (3.2), or rows and then columns (3.3)."),
        Param::length("sigma_d", "Smoothing reach", 3.0, [0.0, 20.0])
            .slider(0.0, 10.0)
            .hint("How far colours are smoothed over what is around them.").doc("Standard deviation of the domain weight."),
        Param::float("sigma_r", "Colour tolerance", 4.25, [0.01, 200.0])
            .slider(0.5, 30.0)
            .hint("How different colours may be and still be smoothed into one.").doc("Standard deviation of the range weight, in CIELAB units or in per cent of RGB."),
        Param::int("iterations", "Rounds", 4, [0, 20])
            .neutral_at_zero()
            .slider(0.0, 10.0)
            .structural()
            .hint("How often the picture is smoothed: more rounds give flatter areas.").doc("Times that the filter runs."),
        Param::choice("space", "Colour space", Space::Lab.selected()).hint("How colours are compared: as the eye sees them, or as they are stored.").doc(
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
        /// CIELAB: differences as the eye sees them.
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
