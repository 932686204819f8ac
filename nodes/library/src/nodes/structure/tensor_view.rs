//! A tensor field made visible (§ 2.6.1, 2.9).

use crate::declare::choice::choice;
use crate::declare::ports;
use crate::declare::spec::{ImageKind, NodeSpec, Param, Port, Scope};
use crate::kernels::shared::stream::Integrator;
use crate::kernels::smoothing::line_integral_convolution::{self, Adapt, Options};
use crate::kernels::structure::tensor_display::{self, Options as Display, Show, least_significant};
use crate::kernels::structure::{colour_restrict, contrast, noise, tensor_interpolate, tensor_logarithm};
use crate::stages::{line_integral_convolution as lic, tensor_options};
use isophote_engine::image::MAX_SIDE;
use isophote_engine::{ImageId, PlanBuilder};

/// The node.
pub static NODE: NodeSpec = NodeSpec {
    id: "tensor_view",
    label: "Tensor view",
    group: "structure",
    hint: "Shows the directions of a picture as flowing lines, as colours or as grey.",
    doc: "Shows a tensor field: noise smeared along its stream lines by line integral convolution; the \
          tangent's orientation as a hue that is the more saturated the more anisotropic the place is \
          (horizontal edges are red); or, as grey, an anisotropy, the gradient's magnitude, a cornerness, \
          or where the orientation is no chance result of noise. Measures without an upper end are shown \
          as v / (v + half): a gradient of 0.1 a pixel, or for corners a measure of 0.05^2, is middle grey. \
          The measures of Harris and Rohr, fourth powers of gradients, are shown by their roots; that of \
          Harris is signed: edges are darker than middle grey, corners lighter.",
    section: "2.6, 2.9.3",
    inputs: &[Port {
        id: "tensor",
        kind: ImageKind::Tensor,
        optional: false,
        doc: "The tensor field to show.",
    }],
    output: ports::color_output("An opaque picture of it."),
    own_params: &[
        Param::choice("show", "Show", View::StreamLines.selected()).hint("What is shown of the directions in the picture.").doc(
            "What to show: stream lines (2.186), the angle of the tangent, the anisotropy (2.137), (2.138) or \
             (2.139), sqrt(lambda1), the condition number c (2.140) as c / (1 + c), the corner measure (2.159), (2.160), (2.161) or det, or the anisotropy \
             where it is significant (2.154) and else black.",
        ),
        Param::length("sigma", "Line length", 6.0, [0.5, 40.0])
            .slider(1.0, 20.0)
            .hint("Length of the flow lines.").doc("Standard deviation of the convolution along the stream lines."),
        Param::float("k", "Corner threshold", 0.04, [0.0, 0.25])
            .slider(0.0, 0.1)
            .hint("How clear a corner must be with Harris corners.").doc("k of the Harris measure det - k tr^2 (2.159); usual are 0.04 to 0.06, from 0.25 on nothing is a corner."),
        Param::float("alpha", "Chance level", 0.05, [0.0001, 0.5])
            .slider(0.001, 0.2)
            .hint("Share of pure noise that may pass for structure.").doc("Share of pure noise that passes for structure, alpha of (2.154)."),
        Param::length("rho", "Found at scale", tensor_options::RHO.default_float(), [0.0, 40.0])
            .slider(0.5, 10.0)
            .hint("Flow scale at which the directions were found. Counts with significance.").doc("Standard deviation that the tensor was smoothed by: significance counts 4 pi rho^2 samples (2.158)."),
    ],
    build,
};

/// Standard deviation of the greys that noise along stream lines is stretched to.
const SPREAD: f32 = 0.22;

choice! {
    /// Measure to show.
    enum View {
        /// Noise, smeared along the lines.
        StreamLines ("lic", "Flow lines"),
        /// The direction as a hue.
        Orientation ("orientation", "Direction"),
        /// The anisotropy: how clear the direction is.
        Anisotropy ("anisotropy", "Anisotropy"),
        /// The anisotropy, with clear directions nearer to each other.
        AnisotropySqrt ("anisotropy_sqrt", "Mild anisotropy"),
        /// The anisotropy, with clear directions further from each other.
        AnisotropySquared ("anisotropy_squared", "Sharp anisotropy"),
        /// The strength of the edges.
        Magnitude ("magnitude", "Edge strength"),
        /// The condition number: grey where no direction is, white on edges.
        Condition ("condition", "Condition number"),
        /// Corners by the measure of Harris.
        Harris ("harris", "Harris corners"),
        /// Corners by the measure of Foerstner.
        Foerstner ("foerstner", "Foerstner corners"),
        /// Corners by the measure of Tomasi and Kanade.
        TomasiKanade ("tomasi_kanade", "Tomasi corners"),
        /// Corners by the measure of Rohr.
        Rohr ("rohr", "Rohr corners"),
        /// The anisotropy where it is no chance, and black elsewhere.
        Significance ("significance", "Significance"),
    }
}

fn build(scope: &mut Scope<'_>) -> ImageId {
    let tensor = scope.required("tensor");
    let show = match scope.option("show") {
        View::StreamLines => {
            let (sigma, scale, origin) = (scope.float("sigma"), scope.scale(), scope.origin());
            return stream_lines(scope.plan, tensor, sigma, scale, origin);
        }
        View::Orientation => Show::Orientation,
        View::Anisotropy => Show::Anisotropy,
        View::AnisotropySqrt => Show::AnisotropySqrt,
        View::AnisotropySquared => Show::AnisotropySquared,
        View::Magnitude => Show::Magnitude,
        View::Harris => Show::Harris,
        View::Foerstner => Show::Foerstner,
        View::TomasiKanade => Show::TomasiKanade,
        View::Rohr => Show::Rohr,
        View::Significance => Show::Significance,
        View::Condition => Show::Condition,
    };
    let rho = scope.float("rho");
    let samples = 4.0 * std::f32::consts::PI * rho * rho;
    let threshold = least_significant(scope.float("alpha"), samples);
    tensor_display::pass(scope.plan, tensor, &Display { show, k: scope.float("k"), threshold })
}

/// Levels beyond the picture's own at which a proxy's stream lines are traced.
const MOST_FINER: u8 = 2;

/// Noise along the stream lines of `tensor`, by a Gaussian of `sigma` pixels. Grains are as fine as pixels, so
/// that proxies down to a quarter of the size trace them at full size and show the means. Where a strong edge
/// ends and a weak one begins, lines turn: logarithms keep such places where they are between the tensors.
fn stream_lines(
    plan: &mut PlanBuilder,
    mut tensor: ImageId,
    sigma: f32,
    scale: f32,
    origin: [f32; 2],
) -> ImageId {
    let allowed = if plan.size().iter().all(|n| n << MOST_FINER <= MAX_SIDE) { MOST_FINER } else { 0 };
    let finer = (1..=allowed).rev().find(|level| scale * f32::from(1_u8 << level) <= 1.0).unwrap_or(0);
    let mut grains = None;
    if finer > 0 {
        tensor = tensor_logarithm::pass(plan, tensor);
    }
    for level in 1..=finer {
        let noise = noise::pass_at(
            plan,
            scale * f32::from(1_u8 << level),
            origin.map(|o| o * f32::from(1_u8 << level)),
            0,
            -(level as i8),
        );
        tensor = tensor_interpolate::pass_to(plan, noise, tensor);
        grains = Some(noise);
    }
    if finer > 0 {
        tensor = tensor_logarithm::pass_inverse(plan, tensor);
    }
    let grains = grains.unwrap_or_else(|| noise::pass(plan, scale, origin, 0));
    // Who looks at a field looks at the lines themselves.
    let options = Options {
        sigma: sigma * f32::from(1_u8 << finer),
        integrator: Integrator::Midpoint,
        adapt: Adapt::None,
        ..lic::options()
    };
    let lines = line_integral_convolution::pass(plan, grains, tensor, &options);
    // The contrast of the full-size picture, which a proxy shows less of.
    let mut shown = contrast::pass(plan, lines, SPREAD / deviation(sigma / scale));
    for _ in 0..finer {
        shown = colour_restrict::pass(plan, shown);
    }
    shown
}

/// Standard deviation that uniform noise keeps under a Gaussian of `sigma` pixels along a line: the
/// mean square of the noise, 1/12, times the integral of the Gaussian's square. Where lines run
/// between pixels, interpolation takes about a third of that; the mean case is 0.8.
fn deviation(sigma: f32) -> f32 {
    let square = 1.0 / (2.0 * std::f32::consts::PI.sqrt() * sigma.max(0.5));
    0.8 * (square / 12.0).sqrt()
}
