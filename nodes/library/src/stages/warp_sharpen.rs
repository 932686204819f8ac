//! Sharpening by warping (§ 4.6).

use crate::declare::spec::Param;
use crate::kernels::colour::luma_gradient;
use crate::kernels::colour::warp::{self, Params};
use crate::kernels::smoothing::gaussian_blur;
use isophote_engine::{Class, ImageId, PlanBuilder};

pub(crate) const SIGMA_W: Param = Param::length("sigma_w", "Edge width", 1.5, [0.1, 20.0]).slider(0.5, 6.0).hint("Width of the edges that are sharpened.").doc(
    "Standard deviation of the Gaussian on the gradient magnitude: the width of the edges that are narrowed.",
);

/// sqrt(2 pi e): sigma^2 times the greatest slope of a Gaussian is 1 over this.
const SLOPE: f32 = 4.132_731;

/// `color` with edges of width `sigma` narrowed by moves of up to `phi` pixels.
pub(crate) fn warped(plan: &mut PlanBuilder, color: ImageId, sigma: f32, phi: f32) -> ImageId {
    let edges = luma_gradient::pass(plan, color);
    let ridges = gaussian_blur::pass(plan, edges, sigma, Class::Field);
    warp::pass(plan, color, ridges, &Params { amount: phi * SLOPE * sigma * sigma, limit: phi })
}
