//! One iteration of the bilateral filter (§ 3.2) or of its xy-separable form (§ 3.3).

use crate::declare::choice::choice;
use crate::declare::spec::Param;
use crate::kernels::smoothing::bilateral::{self, Options, Window};
use isophote_engine::{ImageId, PlanBuilder};

pub(crate) const CUTOFF: Param = Param::float("cutoff", "Window size", 3.0, [1.0, 4.0]).slider(1.0, 3.0).hint("Size of the neighbourhood that is looked at, in smoothing reaches: smaller is faster and rougher.").doc(
    "Radius of the round window in standard deviations, rounded up to pixels. 3 keeps all that counts; the \
     9x9 window that is usual for sigma 3 ends at 1.33.",
);

choice! {
    /// The window.
    pub(crate) enum Kernel {
        /// A disc.
        Full ("full", "All directions"),
        /// A row and then a column.
        Separable ("xy", "Rows, then columns"),
    }
}

/// One iteration of the bilateral filter with one of its kernels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Passes {
    /// The window.
    pub kernel: Kernel,
    /// Options of the passes.
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
