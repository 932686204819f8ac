//! Anisotropic diffusion (§ 3.1): Perona and Malik's, and Weickert's edge-enhancing and
//! coherence-enhancing schemes.

use crate::declare::choice::choice;
use crate::declare::ports;
use crate::declare::spec::{NodeSpec, Param, Scope};
use crate::kernels::smoothing::diffusion_tensor::{self, Scheme};
use crate::kernels::smoothing::perona_malik::{self, Diffusivity, Options};
use crate::kernels::smoothing::{diffusion_step, gaussian_blur};
use crate::kernels::structure::gradient_tensor::{self, Derivative, Measure};
use isophote_engine::{Class, ImageId, PlanBuilder};

/// The node.
pub static NODE: NodeSpec = NodeSpec {
    id: "anisotropic_diffusion",
    label: "Diffusion",
    group: "smoothing",
    hint: "Lets colours run into each other and stop at edges, or run along them.",
    doc: "Diffuses colours and stops at edges: with Perona and Malik's diffusivity (3.2, 3.3), or with a \
          diffusion tensor that smooths along edges but not across them (edge-enhancing), or along lines \
          that it closes (coherence-enhancing). Every step is a weighted mean, so no value leaves the \
          range of its neighbourhood. Transparent pixels lend no colour, and coverage stays as it is.",
    section: "3.1",
    inputs: &[ports::COLOR],
    output: ports::color_output("The diffused picture."),
    own_params: &[
        Param::choice("scheme", "Method", Diffusion::PeronaMalik.selected()).hint("Whether smoothing stops at edges, runs along edges, or runs along lines and closes them."),
        Param::int("iterations", "Rounds", 10, [0, 60]).neutral_at_zero()
            .slider(0.0, 40.0)
            .structural()
            .hint("How often the picture is smoothed.").doc("Steps. Without edges, their number times twice the time step is the variance of the smoothing in px^2."),
        Param::float("time_step", "Step size", 0.2, [0.01, 0.25])
            .hint("How much is smoothed in each round.").doc("Length of a step. Above 1/4 explicit steps would not be stable."),
        Param::float("contrast", "Edge contrast", 4.0, [0.01, 100.0]).slider(0.5, 20.0).hint("Difference of colour that counts as an edge.").doc(
            "Difference of colour that counts as an edge, K or lambda of 3.2, in per cent of RGB: between \
             neighbours (Perona-Malik), or per pixel. Of the coherence-enhancing scheme, four times the \
             gradient above which lines are drawn out.",
        ),
        Param::choice("diffusivity", "Preference", Diffusivity::Rational.selected()).uniform().hint("Whether wide areas or strong edges are kept. Counts with the first method.").doc(
            "Perona-Malik only: 1 / (1 + s^2 / lambda^2), which favours wide regions, or exp(-s^2 / K^2), \
             which favours strong edges (3.2).",
        ),
        Param::length("sigma", "Pre-smoothing", 1.0, [0.0, 10.0])
            .slider(0.0, 4.0)
            .hint("Smoothing before edges are looked for, against noise. Does not count with the first method.").doc("Smoothing before gradients are taken, against noise; not used by Perona-Malik."),
        Param::length("rho", "Flow scale", 3.0, [0.0, 20.0])
            .slider(0.0, 8.0)
            .hint("Size of the lines that are followed. Counts with the method along lines.").doc("Smoothing of the structure tensor, the scale of lines; of the coherence-enhancing scheme only."),
    ],
    build,
};

choice! {
    /// Measure that stops or guides the diffusion.
    enum Diffusion {
        /// Perona and Malik's: less is smoothed where neighbours differ more.
        PeronaMalik ("perona_malik", "Stop at edges"),
        /// Edge-enhancing: smooths along edges and not across them.
        EdgeEnhancing ("edge_enhancing", "Along edges"),
        /// Coherence-enhancing: smooths along lines and closes them.
        CoherenceEnhancing ("coherence_enhancing", "Along lines"),
    }
}

fn build(scope: &mut Scope<'_>) -> ImageId {
    let mut color = scope.required("color");
    let (time_step, contrast) = (scope.float("time_step"), scope.float("contrast") * 0.01);
    let iterations = scope.int("iterations");
    let scheme = match scope.option("scheme") {
        Diffusion::EdgeEnhancing => Scheme::EdgeEnhancing,
        Diffusion::CoherenceEnhancing => Scheme::CoherenceEnhancing,
        Diffusion::PeronaMalik => {
            let options = Options { time_step, contrast, diffusivity: scope.option("diffusivity") };
            for _ in 0..iterations {
                color = perona_malik::pass(scope.plan, color, &options);
            }
            return color;
        }
    };
    let (sigma, rho) = (scope.float("sigma"), scope.float("rho"));
    // Lines are to be found where there is no edge yet.
    let contrast = if scheme == Scheme::CoherenceEnhancing { 0.25 * contrast } else { contrast };
    for _ in 0..iterations {
        let tensors = structure(scope.plan, color, sigma, scheme, rho);
        let weights = diffusion_tensor::pass(scope.plan, tensors, scheme, contrast);
        color = diffusion_step::pass(scope.plan, color, weights, time_step);
    }
    color
}

/// The structure tensor that guides a step. Edges are located by the gradient itself; lines by its
/// mean over a neighbourhood.
fn structure(plan: &mut PlanBuilder, color: ImageId, sigma: f32, scheme: Scheme, rho: f32) -> ImageId {
    let smooth = gaussian_blur::pass_colour(plan, color, sigma);
    let measure = Measure { scale: 1.0, luma: false, normalize: false, threshold: None };
    let tensors = gradient_tensor::pass(plan, smooth, Derivative::Scharr3, measure);
    match scheme {
        Scheme::EdgeEnhancing => tensors,
        Scheme::CoherenceEnhancing => gaussian_blur::pass(plan, tensors, rho, Class::Field),
    }
}
