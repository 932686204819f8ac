//! The generalized Kuwahara filter of Papari et al. (§ 5.3).

use crate::choice::choice;
use crate::kernels::painting::generalized_kuwahara::{self, Options};
use crate::ports;
use crate::spec::{NodeSpec, Param, Scope};
use isophote_engine::ImageId;

/// The node.
pub static NODE: NodeSpec = NodeSpec {
    id: "generalized_kuwahara",
    label: "Generalized Kuwahara",
    group: "painting",
    doc: "A painterly flattening that keeps edges sharp: every pixel takes the mean of the smooth sectors of \
          a disc, those that vary least counting most (5.14). Transparent pixels lend no colour, and \
          coverage stays as it is.",
    section: "5.3",
    inputs: &[ports::COLOR],
    output: ports::color_output("The flattened picture."),
    own_params: &[
        Param::float("radius", "Radius", 6.0, [0.0, 40.0])
            .neutral_at_zero()
            .slider(0.0, 20.0)
            .pixels()
            .doc("Radius of the disc, 2.5 standard deviations of its Gaussian (r)."),
        SECTORS,
        Q,
        THRESHOLD,
        Param::choice("method", "Method", Method::Spatial.selected()).uniform().doc(
            "How the CPU sums up the sectors: pixel by pixel, or by the fast Fourier transform (5.16), whose \
             cost hardly grows with the radius. The picture is the same.",
        ),
    ],
    build,
};

choice! {
    /// How the CPU sums up the sectors.
    enum Method {
        /// Pixel by pixel.
        Spatial ("spatial", "Spatial"),
        /// By the fast Fourier transform (5.16).
        Fourier ("fft", "Fourier transform"),
    }
}

/// N.
pub(crate) const SECTORS: Param = Param::int("sectors", "Sectors", 8, [4, 8])
    .doc("Sectors of the disc (N), 4 or 8, which follow corners and curves better; more than 4 are 8.");
/// q.
pub(crate) const Q: Param = Param::float("q", "Sharpness", 8.0, [1.0, 64.0])
    .slider(1.0, 16.0)
    .doc("Exponent by which flat sectors outweigh others (q of 5.15): higher is sharper.");
/// tau_s.
pub(crate) const THRESHOLD: Param = Param::float("threshold", "Threshold", 0.0627, [0.001, 1.0])
    .slider(0.005, 0.3)
    .doc("Standard deviation below which sectors count as flat (tau_s of 5.15), RGB in 0..1.");

/// The chosen number of sectors.
pub(crate) fn sectors(scope: &Scope<'_>) -> u32 {
    if scope.int("sectors") > 4 { 8 } else { 4 }
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
