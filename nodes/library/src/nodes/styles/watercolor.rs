//! Watercolour (§ 1.2, 5.1): flat washes with dark borders on grained paper, after Bousseau et al. 2006.

use crate::declare::ports;
use crate::declare::spec::{NodeSpec, Param, RENEWAL, STEADINESS, Scope, WINDOW};
use crate::kernels::colour::lab_to_rgb;
use crate::kernels::colour::watercolor_wash::{self, CLOUDS, Wash};
use crate::kernels::smoothing::gaussian_blur;
use crate::kernels::smoothing::line_integral_convolution::{self, Options as Lic};
use crate::kernels::smoothing::wobble::{self, Options as Wobble};
use crate::stages::tensor_options::TensorOptions;
use crate::stages::{ADVANCED, LOOK, abstraction, line_integral_convolution as lic, marks, morphology, tone};
use isophote_engine::ImageId;

/// The node.
pub static NODE: NodeSpec = NodeSpec {
    id: "watercolor",
    label: "Watercolour",
    group: "styles",
    hint: "Washes of thin paint with wavering outlines, pigment at their borders and the grain of the paper.",
    doc: "Washes of thin paint: the bilateral filter along the local structure and a closing followed by \
          an opening simplify the picture, outlines waver, pigment gathers at the borders, in clouds and in \
          the grain of the paper.",
    section: "1.2, 5.1",
    inputs: &[ports::COLOR, ports::REST_POSITION],
    output: ports::color_output("The watercolour."),
    own_params: &[
        Param::length("wash_size", "Wash size", 1.5, [0.0, 30.0])
            .slider(0.0, 12.0)
            .group(LOOK)
            .hint("Size of the smallest patches of colour that are painted.").doc("Radius of these patches."),
        abstraction::DETAIL,
        Param::float("pigment", "Pigment", 0.95, [0.0, 1.0])
            .slider(0.3, 1.0)
            .group(LOOK)
            .hint("How much paint is in the water: 1 keeps the colours, less lets the paper shine through, 0 leaves it white."),
        Param::float("edge_darkening", "Edge darkening", 0.5, [0.0, 1.0])
            .group(LOOK)
            .hint("How much paint gathers at the borders of dark areas."),
        Param::float("clouds", "Clouds", 0.5, [0.0, 1.0])
            .group(LOOK)
            .hint("How unevenly the water carries the paint."),
        Param::float("granulation", "Granulation", 0.5, [0.0, 1.0])
            .group(LOOK)
            .hint("How much paint settles in the grain of the paper."),
        Param::length("wobble", "Wobble", 2.0, [0.0, 20.0])
            .slider(0.0, 6.0)
            .group(LOOK)
            .hint("How far outlines waver.").doc("Far ones waver in waves that are longer than `wavelength`, so that none folds."),
        tone::SATURATION,
        tone::LIGHTS,
        tone::DARKS,
        abstraction::ABSTRACTION,
        abstraction::N_A,
        abstraction::SIGMA_D,
        abstraction::SIGMA_R,
        Param::length("sigma_a", "Edge smoothing", 2.0, [0.0, 20.0])
            .slider(0.0, 5.0)
            .group(ADVANCED)
            .hint("How far patches are smoothed along their outlines.").doc("Standard deviation of the smoothing of the patches along their outlines."),
        Param::length("edge_width", "Edge width", 2.0, [0.0, 30.0])
            .slider(0.0, 10.0)
            .group(ADVANCED)
            .hint("Width of the dark borders.").doc("Standard deviation of a Gaussian."),
        Param::float("wavelength", "Wobble length", 24.0, [2.0, 400.0])
            .slider(8.0, 100.0)
            .group(ADVANCED)
            .hint("Length of the waves in the outlines, in pixels of the full-size picture."),
        Param::float("grain_size", "Grain size", 2.5, [0.5, 40.0])
            .slider(1.0, 10.0)
            .group(ADVANCED)
            .hint("Size of the grain of the paper, in pixels of the full-size picture."),
        STEADINESS,
        WINDOW,
        RENEWAL,
    ],
    build,
};

/// Densities of the look controls at 1.
const MOST_EDGES: f32 = 16.0;
const MOST_CLOUDS: f32 = 0.3;
const MOST_GRAIN: f32 = 0.3;

/// Shortest waves against how far they reach: below 5 outlines could fold.
const SHORTEST_WAVE: f32 = 8.0;

fn build(scope: &mut Scope<'_>) -> ImageId {
    let options = TensorOptions::at_scale(scope.scale());
    let [mut flat, tensors] = abstraction::steady_regions(scope, &options);
    flat = tone::curve(scope, flat);
    let saturation = scope.float("saturation");
    let rgb = lab_to_rgb::pass(scope.plan, flat, saturation);

    // Closing first: watercolours are light (5.1).
    let radius = scope.float("wash_size");
    let closed = morphology::close(scope.plan, rgb, radius);
    let patches = morphology::open(scope.plan, closed, radius);
    let smooth = Lic { sigma: scope.float("sigma_a"), ..lic::options() };
    let patches = line_integral_convolution::pass(scope.plan, patches, tensors, &smooth);
    let (amount, wavelength, scale) = (scope.float("wobble"), scope.float("wavelength"), scope.scale());
    let wavelength = wavelength.max(SHORTEST_WAVE * amount / scale);
    let origin = scope.origin();
    let drawn = wobble::pass(scope.plan, patches, &Wobble { amount, wavelength, scale, origin });

    let edge_width = scope.float("edge_width");
    let blurred = gaussian_blur::pass_colour(scope.plan, drawn, edge_width);
    let wash = Wash {
        scale,
        pigment: scope.float("pigment"),
        edges: scope.float("edge_darkening") * MOST_EDGES,
        clouds: scope.float("clouds") * MOST_CLOUDS,
        grain: scope.float("granulation") * MOST_GRAIN,
        grain_size: scope.float("grain_size"),
        origin,
    };
    let clouds = marks::clouds(scope, CLOUDS);
    watercolor_wash::pass(scope.plan, drawn, blurred, clouds, &wash)
}
