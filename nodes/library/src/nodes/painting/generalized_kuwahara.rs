//! The generalized Kuwahara filter of Papari et al. (§ 5.3).

use crate::declare::choice::choice;
use crate::declare::ports;
use crate::declare::spec::{NodeSpec, Param, Scope};
use crate::kernels::painting::generalized_kuwahara::{self, Options};
use crate::stages::generalized_kuwahara::{Q, SECTORS, THRESHOLD, sectors};
use isophote_engine::ImageId;

/// The node.
pub static NODE: NodeSpec = NodeSpec {
    id: "generalized_kuwahara",
    label: "Smooth Kuwahara",
    group: "painting",
    hint: "Flattens the picture to soft patches like paint and keeps its edges sharp.",
    doc: "A painterly flattening that keeps edges sharp: every pixel takes the mean of the smooth sectors of \
          a disc, those that vary least counting most (5.14). Transparent pixels lend no colour, and \
          coverage stays as it is.",
    section: "5.3",
    inputs: &[ports::COLOR],
    output: ports::color_output("The flattened picture."),
    own_params: &[
        Param::length("radius", "Radius", 6.0, [0.0, 40.0])
            .neutral_at_zero()
            .slider(0.0, 20.0)
            .hint("Size of the patches that colours are averaged over.").doc("Radius of the disc, 2.5 standard deviations of its Gaussian (r)."),
        SECTORS,
        Q,
        THRESHOLD,
        Param::choice("method", "Method", Method::Spatial.selected()).uniform().hint("How the processor adds up; the picture is the same.").doc(
            "How the CPU sums up the sectors: pixel by pixel, or by the fast Fourier transform (5.16), whose \
             cost hardly grows with the radius. The picture is the same.",
        ),
    ],
    build,
};

choice! {
    /// Method by which the CPU sums up the sectors.
    enum Method {
        /// Pixel by pixel.
        Spatial ("spatial", "Pixel by pixel"),
        /// By the fast Fourier transform.
        Fourier ("fft", "Fourier transform"),
    }
}

fn build(scope: &mut Scope<'_>) -> ImageId {
    let color = scope.required("color");
    let options = Options {
        radius: scope.float("radius"),
        sectors: sectors(scope),
        q: scope.float("q"),
        threshold: scope.float("threshold"),
        fft: scope.option::<Method>("method") == Method::Fourier,
    };
    generalized_kuwahara::pass(scope.plan, color, &options)
}
