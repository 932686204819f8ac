//! The bilateral filter (§ 3.2) and its xy-separable form (§ 3.3).
//!
//! Other nodes call `iteration` between passes of their own.

use crate::choice::choice;
use crate::kernels::colour::{lab_to_rgb, rgb_to_lab};
use crate::kernels::smoothing::bilateral::{self, Options, Window};
use crate::ports;
use crate::spec::{NodeSpec, Param, Scope};
use isophote_engine::{ImageId, PlanBuilder};

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
        Param::float("sigma_d", "Sigma d", 3.0, [0.0, 20.0])
            .slider(0.0, 10.0)
            .pixels()
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

pub(crate) const CUTOFF: Param = Param::float("cutoff", "Cut-off", 3.0, [1.0, 4.0]).slider(1.0, 3.0).doc(
    "Radius of the round window in standard deviations, rounded up to pixels. 3 keeps all that counts; the \
     9x9 window that is usual for sigma 3 ends at 1.33.",
);

choice! {
    /// The window.
    pub(crate) enum Kernel {
        /// A disc (3.2).
        Full ("full", "Full"),
        /// A row and then a column (3.3).
        Separable ("xy", "Separable along x and y"),
    }
}

choice! {
    /// Where differences of colour are measured.
    enum Space {
        /// CIELAB, L in 0..100.
        Lab ("lab", "CIELAB"),
        /// Gamma-encoded RGB.
        Rgb ("rgb", "RGB"),
    }
}

/// One iteration of the bilateral filter with one of its kernels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Passes {
    /// The window.
    pub kernel: Kernel,
    /// What the passes are asked for.
    pub options: Options,
}

/// One iteration, usually on a CIELAB image.
pub(crate) fn iteration(plan: &mut PlanBuilder, color: ImageId, passes: &Passes) -> ImageId {
    match passes.kernel {
        Kernel::Full => bilateral::pass(plan, color, Window::Disc, &passes.options),
        Kernel::Separable => {
            let rows = bilateral::pass(plan, color, Window::Row, &passes.options);
            bilateral::pass(plan, rows, Window::Column, &passes.options)
        }
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
