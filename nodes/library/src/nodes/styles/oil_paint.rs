//! Oil paint (§ 1.2): noise smoothed along the flow makes the marks of a brush, colours smoothed along
//! the flow its strokes.

use crate::declare::ports;
use crate::declare::spec::{HOLD, NodeSpec, Param, RENEWAL, STEADINESS, Scope, WINDOW};
use crate::declare::value::Value;
use crate::kernels::colour::lab_to_rgb;
use crate::kernels::colour::paint_relief::{self, Relief};
use crate::kernels::smoothing::flow_dilation;
use crate::kernels::smoothing::line_integral_convolution::{self, Adapt, Options as Lic};
use crate::stages::tensor_options::TensorOptions;
use crate::stages::{ADVANCED, LOOK, abstraction, line_integral_convolution as lic, marks, tone};
use isophote_engine::{ImageId, math};

/// The node.
pub static NODE: NodeSpec = NodeSpec {
    id: "oil_paint",
    label: "Oil paint",
    group: "styles",
    hint: "Brush strokes of thick paint that follow the shapes, with marks of bristles and light on them.",
    doc: "Brush strokes that follow the shapes: regions are flattened, painted in strokes of one colour \
          along the local orientation and smoothed along it; noise smoothed the same way gives the marks \
          of bristles, and the light on them.",
    section: "1.2",
    inputs: &[ports::COLOR, ports::REST_POSITION],
    output: ports::color_output("The painting."),
    own_params: &[
        STROKE_LENGTH,
        STROKE_WIDTH,
        Param::float("bristle", "Bristle", 0.5, [0.0, 1.0])
            .group(LOOK)
            .hint("How clearly the marks of the bristles show.").doc("How dark and light the marks are: up to 20 units of L on white."),
        Param::float("shine", "Shine", 0.4, [0.0, 1.0])
            .group(LOOK)
            .hint("How much light the ridges of the paint catch.").doc("Up to 30 units of L on white."),
        Param::float("light_angle", "Light angle", 120.0, [0.0, 360.0])
            .degrees()
            .group(LOOK)
            .hint("Where the light comes from: 0 is the right, 90 above, 180 the left."),
        abstraction::DETAIL,
        tone::SATURATION,
        tone::LIGHTS,
        tone::DARKS,
        abstraction::ABSTRACTION,
        abstraction::N_A.with_default(Value::Int(2)).doc("Bilateral iterations before the strokes."),
        abstraction::SIGMA_D,
        abstraction::SIGMA_R,
        Param::length("rho", "Flow scale", 3.0, [0.0, 20.0])
            .slider(0.0, 8.0)
            .group(ADVANCED)
            .hint("How gently strokes turn.").doc("Standard deviation of the smoothing of the structure tensor: strokes turn no faster."),
        Param::int("levels", "Scales", 5, [1, 8])
            .structural()
            .group(ADVANCED)
            .hint("Sizes at which directions are looked for: more let strokes in flat areas follow what is around.").doc("Scales at which the orientation is found (2.8)."),
        Param::length("dilation_length", "Colour length", 8.0, [0.0, 60.0])
            .slider(0.0, 30.0)
            .group(ADVANCED)
            .hint("How far a stroke keeps one colour, to each side.").doc("Arc length on each side over which strokes take one colour (5.1)."),
        Param::length("sigma_t", "Colour smoothing", 3.0, [0.0, 40.0])
            .slider(0.0, 20.0)
            .group(ADVANCED)
            .hint("How far colours are smoothed along the strokes.").doc("Standard deviation of the smoothing of colours along the flow."),
        Param::length("sigma_n", "Bristle width", 1.0, [0.0, 10.0])
            .slider(0.0, 4.0)
            .group(ADVANCED)
            .hint("How wide strokes and the marks of bristles are.").doc("Standard deviation of the smoothing of the noise."),
        Param::length("sigma_b", "Bristle length", 10.0, [0.0, 40.0])
            .slider(0.0, 20.0)
            .group(ADVANCED)
            .hint("How long the marks of bristles are.").doc("Standard deviation of the smoothing of the noise along the flow."),
        Param::int("seed", "Seed", 1, [0, 9999])
            .slider(0.0, 100.0)
            .group(ADVANCED)
            .hint("Another number gives other strokes."),
        STEADINESS,
        WINDOW,
        HOLD,
        RENEWAL,
    ],
    build,
};

const STROKE_LENGTH: Param = Param::length("stroke_length", "Stroke length", 20.0, [0.0, 80.0])
    .slider(2.0, 50.0)
    .group(LOOK)
    .hint("How long brush strokes are.")
    .doc("Scales `dilation_length`, `sigma_t` and `sigma_b` by length / 20.");
const STROKE_WIDTH: Param = Param::length("stroke_width", "Stroke width", 4.0, [0.5, 20.0])
    .slider(1.0, 12.0)
    .group(LOOK)
    .hint("How wide brush strokes are.")
    .doc("Scales `sigma_n` and `rho` by width / 4.");

/// Units of L, on white, of the look controls at 1.
const MOST_BRISTLE: f32 = 20.0;
const MOST_SHINE: f32 = 30.0;

fn build(scope: &mut Scope<'_>) -> ImageId {
    // Ratios of two lengths have no unit: the scale of the rendering is taken out again.
    let length = scope.float("stroke_length") / (STROKE_LENGTH.default_float() * scope.scale());
    let width = scope.float("stroke_width") / (STROKE_WIDTH.default_float() * scope.scale());
    let options = TensorOptions {
        rho: scope.float("rho") * width,
        levels: scope.int("levels"),
        ..TensorOptions::default()
    };
    let [flat, tensors] = abstraction::steady_regions(scope, &options);
    let (scale, seed) = (scope.scale(), scope.renewed(scope.int("seed") as u32));
    let sigma_n = scope.float("sigma_n") * width;
    let grains = marks::grains(scope, sigma_n, seed);

    let dilation_length = scope.float("dilation_length") * length;
    let strokes = flow_dilation::pass(scope.plan, flat, tensors, grains, dilation_length, true);
    // Grains are about as fine as pixels: none may be left out.
    let along = |sigma: f32| Lic { sigma, adapt: Adapt::Anisotropy, ..lic::options() };
    let sigma_t = scope.float("sigma_t") * length;
    let mut painted = line_integral_convolution::pass(scope.plan, strokes, tensors, &along(sigma_t));

    let sigma_b = scope.float("sigma_b") * length;
    let heights = line_integral_convolution::pass_unadapted(scope.plan, grains, tensors, &along(sigma_b));
    // The marks of a proxy are those of the full picture, seen from further away.
    let gain = evenness(sigma_n / scale, sigma_b / scale);
    let relief = Relief {
        bristle: scope.float("bristle") * MOST_BRISTLE * gain,
        // Wide marks are flatter: what counts is their height against their width.
        shine: scope.float("shine") * MOST_SHINE * gain * sigma_n.max(0.5 * scale),
        angle: scope.float("light_angle"),
    };
    painted = paint_relief::pass(scope.plan, painted, heights, &relief);

    painted = tone::curve(scope, painted);
    let saturation = scope.float("saturation");
    lab_to_rgb::pass(scope.plan, painted, saturation)
}

/// Factor by which uniform noise, smoothed by `across` pixels and then along lines by `along`, gets a
/// standard deviation of 1/4, so that marks of any size are equally strong.
fn evenness(across: f32, along: f32) -> f32 {
    // Each axis of a Gaussian reduces the variance of independent values by 1 / (2 sqrt(pi) sigma).
    let reduced = |sigma: f32| (3.545 * sigma).max(1.0);
    let deviation = (1.0 / 12.0 / (reduced(across) * reduced(math::hypot(across, along)))).sqrt();
    0.25 / deviation
}
