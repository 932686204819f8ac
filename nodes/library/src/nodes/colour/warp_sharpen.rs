//! Sharpening by warping (§ 4.6): the picture is pulled away from its edges, which narrows them.

use crate::declare::ports;
use crate::declare::spec::{NodeSpec, Param, Scope};
use crate::stages::warp_sharpen::{SIGMA_W, warped};
use isophote_engine::ImageId;

/// The node.
pub static NODE: NodeSpec = NodeSpec {
    id: "warp_sharpen",
    label: "Warp sharpen",
    group: "colour",
    hint: "Sharpens edges by pulling pixels towards them, without halos.",
    doc: "Sharpens edges by moving pixels towards them, as image-based warping does: samples are taken \
          away from the ridges of the smoothed gradient magnitude, found by the Sobel operator (2.23). No \
          value leaves the range of its neighbourhood.",
    section: "4.6",
    inputs: &[ports::COLOR],
    output: ports::color_output("The sharpened picture."),
    own_params: &[
        SIGMA_W,
        Param::length("phi_w", "Strength", 2.7, [0.0, 20.0]).neutral_at_zero()
            .slider(0.0, 10.0)
            .hint("How far pixels are pulled towards the edges.").doc("How far a sharp edge from black to white moves what is beside it, which is also the farthest move."),
    ],
    build,
};

fn build(scope: &mut Scope<'_>) -> ImageId {
    let color = scope.required("color");
    let (sigma, phi) = (scope.float("sigma_w"), scope.float("phi_w"));
    warped(scope.plan, color, sigma, phi)
}
