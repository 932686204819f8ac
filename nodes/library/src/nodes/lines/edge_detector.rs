//! Classical edge detection (§ 4.1, 4.2.1): lines one pixel wide, as computer vision draws them.

use crate::declare::ports;
use crate::declare::spec::{NodeSpec, Param, Scope};
use crate::kernels::colour::rgb_to_lab;
use crate::kernels::lines::edge_candidates::{self, Method, Options};
use crate::kernels::lines::{edge_gradient, edge_hysteresis};
use crate::stages::difference_of_gaussians as dog;
use crate::stages::line_width;
use isophote_engine::ImageId;

/// The node.
pub static NODE: NodeSpec = NodeSpec {
    id: "edge_detector",
    label: "Edge detector",
    group: "lines",
    hint: "Thin lines at the edges of the picture, found by classical detectors: white is paper, black is line.",
    doc: "Edges of the lightness by classical detectors: Canny's (maxima of the gradient, joined by \
          hysteresis), the thresholded Sobel operator, or zero crossings of the Laplacian of Gaussian. 1 is \
          paper, 0 is line. Lines are one pixel of the full-size picture wide; smaller renderings show them lighter, \
          three tenths dark at least. Thresholds are heights: a \
          step between two pixels counts by the L that it rises, whatever `sigma` makes of it.",
    section: "4.1, 4.2.1",
    inputs: &[ports::COLOR],
    output: dog::EDGES,
    own_params: &[
        Param::choice("method", "Method", Method::Maximum.selected()).hint("How edges are found: as thin joined lines, as soft bands, or as closed contours.").doc(
            "Canny: thin, joined lines at maxima of the gradient. Sobel: the magnitude of the gradient, from \
             `low` (paper) to `high` (line). Zero crossings: where the Laplacian of Gaussian changes its \
             sign (4.3), joined like Canny's.",
        ),
        Param::length("sigma", "Smoothing", 1.4, [0.0, 20.0])
            .slider(0.0, 5.0)
            .hint("How far the picture is smoothed before edges are looked for; 0 for not at all.").doc("Standard deviation of the smoothing before differentiation; 0 for none."),
        Param::float("low", "Weak edges", 10.0, [0.0, 200.0])
            .slider(0.0, 100.0)
            .hint("Contrast from which on an edge may continue a stronger one.").doc("Height, in L per pixel of an unsmoothed step, from which on an edge may continue a stronger one."),
        Param::float("high", "Strong edges", 30.0, [0.0, 200.0])
            .slider(0.0, 100.0)
            .hint("Contrast from which on an edge is drawn by itself.").doc("Height, in L per pixel of an unsmoothed step, from which on an edge is drawn by itself."),
        Param::length("reach", "Joining distance", 120.0, [0.0, 600.0])
            .slider(0.0, 240.0)
            .structural()
            .hint("How far weak edges are followed from a strong one.").doc(
                "Hysteresis: how far, along a chain of edges above `low`, the nearest one above `high` may be. \
                 Twelve pixels take a pass; tiles read as far around them.",
            ),
    ],
    build,
};

fn build(scope: &mut Scope<'_>) -> ImageId {
    let color = scope.required("color");
    let method = scope.option("method");
    let sigma = scope.float("sigma");
    let options = Options { method, low: scope.float("low"), high: scope.float("high") };
    let lab = rgb_to_lab::pass(scope.plan, color, 1.0);
    let gradient = edge_gradient::pass(scope.plan, lab, sigma, method == Method::Magnitude);
    let candidates = edge_candidates::pass(scope.plan, gradient, &options);
    if method == Method::Magnitude {
        return candidates;
    }
    // Lines are a pixel of the full-size picture wide.
    let darkness = line_width::darkness(scope.scale());
    let reach = scope.float("reach").ceil().max(0.0) as u32;
    edge_hysteresis::pass(scope.plan, candidates, reach, darkness)
}
