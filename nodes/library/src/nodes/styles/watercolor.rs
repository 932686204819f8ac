//! Watercolour (§ 1.2, 5.1): transparent washes with dark borders on grained white paper, after Bousseau et al. 2006;
//! bleeding, gaps and dry brush after Montesdeoca et al. 2017.

use crate::declare::ports;
use crate::declare::spec::{NodeSpec, Param, RENEWAL, STEADINESS, Scope, WINDOW};
use crate::kernels::colour::quantize_luminance::Steepness;
use crate::kernels::colour::watercolor_wash::{self, CLOUDS, Drawn, Wash};
use crate::kernels::colour::{keep_detail, lab_to_rgb};
use crate::kernels::smoothing::gaussian_blur;
use crate::kernels::smoothing::line_integral_convolution::{self, Options as Lic};
use crate::kernels::smoothing::wobble::{self, Options as Wobble};
use crate::stages::control::Control;
use crate::stages::steady::{Agreement, COLOUR_AGREEMENT, steadied};
use crate::stages::tensor_options::TensorOptions;
use crate::stages::{
    ADVANCED, LOOK, abstraction, line_integral_convolution as lic, marks, morphology, paper,
    quantize_luminance, tone,
};
use isophote_engine::ImageId;

/// The node.
pub static NODE: NodeSpec = NodeSpec {
    id: "watercolor",
    label: "Watercolour",
    group: "styles",
    hint: "Transparent washes on white paper, with wavering outlines, pigment at their borders, and bare or wet places.",
    doc: "Transparent washes on white paper: the bilateral filter along the local structure, a few glazes and a \
          closing followed by an opening simplify the picture, and what is small but plain to see is painted over \
          it; outlines waver. Pigment gathers at borders, in clouds, in the grain of the paper and at the rims of \
          backruns (Bousseau et al. 2006); wet places bleed, and dry ones leave gaps and bare grain (Montesdeoca et \
          al. 2017). The darkest wash keeps some paper, and the lights are paper.",
    section: "1.2, 5.1",
    inputs: &[ports::COLOR, ports::REST_POSITION, ports::PAPER],
    output: ports::color_output("The watercolour."),
    own_params: &[
        Param::float("mark_size", "Mark size", 2.5, [0.1, 10.0])
            .slider(0.5, 5.0)
            .group(LOOK)
            .hint("Size of all that paint and paper leave: washes, borders, bleeding, waves and grain.")
            .doc("Factor on `wash_size`, `edge_width`, `bleeding_width`, `wavelength` and `grain_size`; the first three reach no farther than 30 px."),
        Param::length("wash_size", "Wash size", 1.5, [0.0, 30.0])
            .slider(0.0, 12.0)
            .group(LOOK)
            .hint("Size of the smallest patches of colour that are painted.").doc("Their radius is 1.1 times this at a mark size of 1."),
        abstraction::DETAIL,
        Param::float("pigment", "Pigment", 0.95, [0.0, 1.0])
            .slider(0.3, 1.0)
            .group(LOOK)
            .hint("How much paint is in the water: 1 is the darkest that still shows some paper, 0 leaves it white."),
        Param::float("edge_darkening", "Edge darkening", 0.5, [0.0, 1.0])
            .group(LOOK)
            .hint("How much paint gathers at the borders of dark areas."),
        Param::float("white_paper", "White paper", 0.6, [0.0, 1.0])
            .group(LOOK)
            .hint("How much of the light is paper without paint."),
        Param::float("bleeding", "Bleeding", 0.8, [0.0, 1.0])
            .group(LOOK)
            .hint("How much colours run into each other where the paper is wet."),
        Param::float("gaps", "Gaps", 0.8, [0.0, 1.0])
            .group(LOOK)
            .hint("How much paper is left bare beside dark shapes where the brush is dry."),
        Param::float("dry_brush", "Dry brush", 0.3, [0.0, 1.0])
            .group(LOOK)
            .hint("How much paint skips the grain of the paper where the brush is dry."),
        Param::float("backruns", "Backruns", 0.5, [0.0, 1.0])
            .group(LOOK)
            .hint("How much water runs back into drying paint and pushes it to a rim."),
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
        Param::length("bleeding_width", "Bleeding width", 2.2, [0.0, 30.0])
            .slider(0.0, 12.0)
            .group(ADVANCED)
            .hint("How far colours run where the paper is wet.").doc("Standard deviation of a Gaussian, no less than `edge_width`."),
        Param::int("glazes", "Glazes", 6, [0, 64])
            .slider(0.0, 12.0)
            .structural()
            .group(ADVANCED)
            .hint("Number of washes from white to the darkest, laid over each other; 0 lets tones run on.")
            .doc("Bins of L; they step where the picture changes."),
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

/// Densities and shares of the look controls at 1.
const MOST_EDGES: f32 = 22.0;
const MOST_CLOUDS: f32 = 1.4;
const MOST_GRAIN: f32 = 0.85;
const MOST_BACKRUNS: f32 = 0.56;

/// Share of the paper that the darkest paint covers: transparent paint is never black.
const DARKEST: f32 = 0.855;

/// Square of the darkness of which the paper keeps half at the most, against the light that is left.
const WHITEST: f32 = 0.15;

/// Strength of colours, which the paper that shines through makes paler.
const VIVID: f32 = 1.2;

/// Factors on `sigma_r` and on the radius of the smallest washes: a brush for washes is broader than one for lines.
const TOLERANCE: f32 = 2.4;
const BROAD: f32 = 1.1;

/// Differences that a wash passes over, and those that a finer brush paints, at the default detail.
const PAINTED: [f32; 2] = [0.06, 0.19];

/// Steepness of the borders of glazes against their height, and the gradient, in L per pixel of the full-size picture,
/// that borders follow.
const CRISP: f32 = 0.067;
const LEAST_GRADIENT: f32 = 0.3;

/// Longest lengths of filters, pixels of the full-size picture.
const FARTHEST: f32 = 30.0;

/// Shortest waves against how far they reach: below 5 outlines could fold.
const SHORTEST_WAVE: f32 = 8.0;

fn build(scope: &mut Scope<'_>) -> ImageId {
    let [_, patches] = steadied(scope, Agreement::lab(COLOUR_AGREEMENT), patches);
    let (amount, scale, origin) = (scope.float("wobble"), scope.scale(), scope.origin());
    let wavelength = scope.float("wavelength") * scope.float("mark_size");
    let wavelength = wavelength.max(SHORTEST_WAVE * amount / scale);
    let color = wobble::pass(scope.plan, patches, &Wobble { amount, wavelength, scale, origin });

    let mark_size = scope.float("mark_size");
    let [edge, bleeding] = ["edge_width", "bleeding_width"].map(|width| within_reach(scope, width));
    let blurred = gaussian_blur::pass_colour(scope.plan, color, edge);
    // Of two Gaussians, one after the other, the squares of the widths add up.
    let further = (bleeding * bleeding - edge * edge).max(0.0).sqrt();
    let wide = gaussian_blur::pass_colour(scope.plan, blurred, further);
    let (clouds, paper) = (marks::clouds(scope, CLOUDS), paper::given(scope));
    let drawn = Drawn { color, blurred, wide, clouds, paper };
    let wash = Wash {
        scale,
        pigment: scope.float("pigment") * DARKEST,
        edges: scope.float("edge_darkening") * MOST_EDGES,
        clouds: scope.float("clouds") * MOST_CLOUDS,
        grain: scope.float("granulation") * MOST_GRAIN,
        grain_size: scope.float("grain_size") * mark_size,
        origin,
        white: scope.float("white_paper") * WHITEST,
        bleeding: scope.float("bleeding"),
        gaps: scope.float("gaps"),
        dry: scope.float("dry_brush"),
        backruns: scope.float("backruns") * MOST_BACKRUNS,
    };
    let painted = watercolor_wash::pass(scope.plan, &drawn, &wash);
    Control::of(scope).diluted(scope.plan, painted)
}

/// A length times the size of marks, as far as filters reach whose work grows with it.
fn within_reach(scope: &Scope<'_>, length: &str) -> f32 {
    (scope.float(length) * scope.float("mark_size")).min(FARTHEST * scope.scale())
}

/// The picture without small differences, by which frames are compared, and its washes in a few tones, without what is
/// small and faint.
fn patches(scope: &mut Scope<'_>) -> [ImageId; 2] {
    let options = TensorOptions::at_scale(scope.scale());
    let [smoothed, tensors] = abstraction::regions(scope, &options, TOLERANCE);
    let mut flat = tone::curve(scope, smoothed);
    let glazes = scope.int("glazes");
    if glazes > 0 {
        let steepness = Steepness::Fixed(CRISP * glazes as f32);
        flat = quantize_luminance::stepped(scope, flat, glazes, steepness, LEAST_GRADIENT);
    }
    let saturation = scope.float("saturation") * VIVID;
    let rgb = lab_to_rgb::pass(scope.plan, flat, saturation);

    // Closing first: watercolours are light (5.1).
    let radius = within_reach(scope, "wash_size") * BROAD;
    let closed = morphology::close(scope.plan, rgb, radius);
    let simple = morphology::open(scope.plan, closed, radius);
    let [_, factor] = abstraction::detail_factors(scope.float("detail"));
    let painted = keep_detail::pass(scope.plan, simple, rgb, PAINTED.map(|difference| difference * factor));
    let painted = Control::of(scope).kept(scope.plan, [rgb, painted]);
    let smooth = Lic { sigma: scope.float("sigma_a"), ..lic::options() };
    [smoothed, line_integral_convolution::pass(scope.plan, painted, tensors, &smooth)]
}
