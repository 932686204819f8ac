//! Sharpening by warping (§ 4.6): the picture is pulled away from its edges, which narrows them.

use crate::kernels::colour::luma_gradient;
use crate::kernels::colour::warp::{self, Params};
use crate::kernels::smoothing::gaussian_blur;
use crate::ports;
use crate::spec::{NodeSpec, Param, Scope};
use isophote_engine::{Class, ImageId, PlanBuilder};

/// The node.
pub static NODE: NodeSpec = NodeSpec {
    id: "warp_sharpen",
    label: "Warp Sharpen",
    group: "colour",
    doc: "Sharpens edges by moving pixels towards them, as image-based warping does: samples are taken \
          away from the ridges of the smoothed gradient magnitude, found by the Sobel operator (2.23). No \
          value leaves the range of its neighbourhood.",
    section: "4.6",
    inputs: &[ports::COLOR],
    output: ports::color_output("The sharpened picture."),
    own_params: &[
        SIGMA_W,
        Param::float("phi_w", "Phi w", 2.7, [0.0, 20.0]).neutral_at_zero()
            .slider(0.0, 10.0)
            .pixels()
            .doc("How far a sharp edge from black to white moves what is beside it, which is also the farthest move."),
    ],
    build,
};

pub(crate) const SIGMA_W: Param = Param::float("sigma_w", "Sigma w", 1.5, [0.1, 20.0])
    .slider(0.5, 6.0)
    .pixels()
    .doc("Standard deviation of the Gaussian on the gradient magnitude: the width of the edges that are narrowed.");

/// sqrt(2 pi e): sigma^2 times the greatest slope of a Gaussian is 1 over this.
const SLOPE: f32 = 4.132_731;

fn build(scope: &mut Scope<'_>) -> ImageId {
    let color = scope.required("color");
    let (sigma, phi) = (scope.float("sigma_w"), scope.float("phi_w"));
    warped(scope.plan, color, sigma, phi)
}

/// `color` with edges of width `sigma` narrowed by moves of up to `phi` pixels.
pub(crate) fn warped(plan: &mut PlanBuilder, color: ImageId, sigma: f32, phi: f32) -> ImageId {
    let edges = luma_gradient::pass(plan, color);
    let ridges = gaussian_blur::pass(plan, edges, sigma, Class::Field);
    warp::pass(plan, color, ridges, &Params { amount: phi * SLOPE * sigma * sigma, limit: phi })
}
