//! The extended difference of Gaussians filter (§ 4.2-4.4).

use crate::declare::ports;
use crate::declare::spec::{NodeSpec, Scope};
use crate::kernels::colour::lightness;
use crate::kernels::lines::dog_columns::{self, Options};
use crate::kernels::shared::edge_threshold::Xdog;
use crate::stages::difference_of_gaussians::{
    EDGES, EPSILON, EPSILON_P, FORM, K, P, PHI, PHI_P, SIGMA_E, TAU, THRESHOLD, fades, xdog,
};
use crate::stages::line_width;
use isophote_engine::ImageId;

/// The node.
pub static NODE: NodeSpec = NodeSpec {
    id: "difference_of_gaussians",
    label: "Plain lines",
    group: "lines",
    hint: "Draws lines at edges of any direction: white is paper, black is line.",
    doc: "Lines by the extended difference of Gaussians on lightness (4.7, 4.8) or its sharpening form \
          (4.10): 1 is paper, 0 is line. Transparent pixels neither draw nor receive lines.",
    section: "4.2-4.4",
    inputs: &[ports::COLOR],
    output: EDGES,
    own_params: &[SIGMA_E, K, FORM, TAU, EPSILON, PHI, P, EPSILON_P, PHI_P, THRESHOLD],
    build,
};

fn build(scope: &mut Scope<'_>) -> ImageId {
    let color = scope.required("color");
    let sigma = scope.float("sigma_e");
    let faintness = if fades(scope) { line_width::faintness(sigma) } else { 0.0 };
    let options = Options {
        sigma: line_width::drawable(sigma),
        k: scope.float("k"),
        xdog: Xdog { faintness, ..xdog(scope) },
    };
    let lightness = lightness::pass(scope.plan, color);
    dog_columns::pass(scope.plan, lightness, &options)
}
