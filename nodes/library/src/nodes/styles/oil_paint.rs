//! Oil paint (§ 1.2): brush strokes of thick paint, coarse ones first and finer ones where the picture asks for them
//! (Hertzmann, Painterly rendering with curved brush strokes of multiple sizes, 1998).

use crate::declare::ports;
use crate::declare::spec::{HOLD, NodeSpec, Param, Port, RENEWAL, STEADINESS, Scope, WINDOW};
use crate::declare::value::Value;
use crate::kernels::colour::lab_to_rgb;
use crate::kernels::colour::paint_relief::{self, Relief};
use crate::stages::control::Control;
use crate::stages::strokes::{self, Brush, Subject};
use crate::stages::tensor_options::TensorOptions;
use crate::stages::{ADVANCED, LOOK, abstraction, flow_dog, tone};
use isophote_engine::ImageId;

/// The node.
pub static NODE: NodeSpec = NodeSpec {
    id: "oil_paint",
    label: "Oil paint",
    group: "styles",
    hint: "Brush strokes of thick paint that follow the shapes, with marks of bristles and light on them.",
    doc: "Brush strokes that follow the shapes: regions are flattened and painted in layers of strokes, coarse \
          ones everywhere and finer ones where the picture has detail of their size (after Hertzmann 1998). A \
          stroke has a colour of its own, bends with the local orientation and ends where the colour does; its \
          bristles leave ridges, and the light lies on them. Strokes belong to things: to their rest position, \
          else to their motion.",
    section: "1.2",
    inputs: &[ports::COLOR, OBJECT_ID, ports::REST_POSITION],
    output: ports::color_output("The painting."),
    own_params: &[
        STROKE_LENGTH,
        STROKE_WIDTH,
        Param::float("bristle", "Bristle", 0.5, [0.0, 1.0])
            .group(LOOK)
            .hint("How clearly the marks of the bristles show.").doc("How dark and light the marks are, up to 20 units of L on white, and how ragged the ends of strokes."),
        Param::float("shine", "Shine", 0.4, [0.0, 1.0])
            .group(LOOK)
            .hint("How much light the ridges of the paint catch.").doc("Up to 60 units of L on white."),
        Param::float("light_angle", "Light angle", 120.0, [0.0, 360.0])
            .degrees()
            .group(LOOK)
            .hint("Where the light comes from: 0 is the right, 90 above, 180 the left."),
        Param::float("dryness", "Dry brush", 0.0, [0.0, 1.0])
            .group(LOOK)
            .hint("How soon the brush runs dry: streaks of what lies below show.")
            .doc("Share of a stroke that paint does not cover, less at its beginning and more at its end."),
        Param::float("variation", "Colour variation", 0.5, [0.0, 1.0])
            .group(LOOK)
            .hint("How different the colours of neighbouring strokes are.")
            .doc("Up to 10 units of L, 0.35 radians of hue and two fifths of chroma from stroke to stroke."),
        abstraction::DETAIL.doc(
            "Scales `sigma_r` from 3 to 1/3 times and `sigma_d` from 2 to 1/2, and the difference from which on finer \
             strokes are painted from 17 to 2 units of Lab.",
        ),
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
        Param::int("layers", "Layers", 3, [1, 4])
            .structural()
            .group(ADVANCED)
            .hint("Sizes of strokes, from coarse to fine: more paint finer things.")
            .doc("Layers of strokes, each half as large as the one below; `stroke_length` and `stroke_width` are those of the third."),
        Param::float("curve", "Bend", 1.0, [0.0, 1.0])
            .group(ADVANCED)
            .hint("How far strokes bend with the shapes: 0 keeps them straight.")
            .doc("Share of the turn of the tangent along a stroke that its curvature takes on."),
        Param::length("dilation_length", "Colour length", 8.0, [0.0, 60.0])
            .slider(0.0, 30.0)
            .structural()
            .group(ADVANCED)
            .hint("How far a stroke keeps one colour, to each side.").doc("Half the length of strokes of the third layer, along which they keep one colour."),
        Param::length("sigma_t", "Colour smoothing", 3.0, [0.0, 40.0])
            .slider(0.0, 20.0)
            .group(ADVANCED)
            .hint("How far colours are smoothed along the strokes.").doc("Distance along a stroke of the third layer at which the picture counts half for its colour."),
        Param::length("sigma_n", "Bristle width", 1.0, [0.0, 10.0])
            .slider(0.0, 4.0)
            .group(ADVANCED)
            .hint("How wide the marks of bristles are.").doc("Cells of the noise of bristles, across strokes."),
        Param::length("sigma_b", "Bristle length", 10.0, [0.0, 40.0])
            .slider(0.0, 20.0)
            .group(ADVANCED)
            .hint("How long the marks of bristles are.").doc("Cells of the noise of bristles, along strokes."),
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

const OBJECT_ID: Port = Port { doc: "Object numbers; strokes end at borders.", ..flow_dog::OBJECT_ID };
const STROKE_LENGTH: Param = Param::length("stroke_length", "Stroke length", 20.0, [0.0, 80.0])
    .slider(2.0, 50.0)
    .structural()
    .group(LOOK)
    .hint("How long the finest brush strokes are; coarse ones are four times as long.")
    .doc("Scales `dilation_length`, `sigma_t` and `sigma_b` by length / 20. Strokes of lower layers are two and four times as long.");
const STROKE_WIDTH: Param = Param::length("stroke_width", "Stroke width", 4.0, [0.5, 20.0])
    .slider(1.0, 12.0)
    .structural()
    .group(LOOK)
    .hint("How wide the finest brush strokes are; coarse ones are four times as wide.")
    .doc("Width of strokes of the finest of three layers; scales `sigma_n` and `rho` by (width / 4)^1/2.");

/// Detail that is painted beside the control's where `steadiness` is 1: fine strokes follow what moves, coarse ones jump with it.
const FINER: f32 = 0.4;
/// Units of L, on white, of the look controls at 1.
const MOST_BRISTLE: f32 = 20.0;
const MOST_SHINE: f32 = 60.0;
/// Size of strokes over the one that they seem to have: their sides and ends are ragged.
const FULL: f32 = 1.25;
/// Cells of the noise of bristles against what looks one bristle wide.
const BRISTLE: f32 = 1.25;

fn build(scope: &mut Scope<'_>) -> ImageId {
    let scale = scope.scale();
    // Ratios of two lengths have no unit: the scale of the rendering is taken out again.
    let length = scope.float("stroke_length") / (STROKE_LENGTH.default_float() * scale);
    let width = scope.float("stroke_width");
    let wider = (width / (STROKE_WIDTH.default_float() * scale)).sqrt();
    let options = TensorOptions {
        rho: scope.float("rho") * wider,
        levels: scope.int("levels"),
        ..TensorOptions::default()
    };
    let [picture, tensors] = abstraction::steady_regions(scope, &options);
    let brush = Brush {
        layers: scope.int("layers"),
        half_width: 0.5 * FULL * width,
        half_length: FULL * scope.float("dilation_length") * length,
        curve: scope.float("curve"),
        detail: scope.float("detail") + FINER * scope.float(STEADINESS.id),
        smoothing: scope.float("sigma_t") * length,
        variation: scope.float("variation"),
        dryness: scope.float("dryness"),
        // A knife has no bristles, and leaves clean ends.
        raggedness: (2.0 * scope.float("bristle")).min(1.5),
        bristles: [BRISTLE * scope.float("sigma_n") * wider, BRISTLE * scope.float("sigma_b") * length],
        seed: scope.renewed(scope.int("seed") as u32),
    };
    let subject = Subject { picture, tensors, ids: scope.input("object_id") };
    let mut painted = picture;
    if let Some([strokes, heights]) = strokes::painted(scope, &subject, &brush) {
        let relief = Relief {
            bristle: scope.float("bristle") * MOST_BRISTLE,
            // Of a proxy's ridges the slopes are steeper by as much as they are narrower.
            shine: scope.float("shine") * MOST_SHINE * scale,
            angle: scope.float("light_angle"),
        };
        let thick = paint_relief::pass(scope.plan, strokes, heights, &relief);
        painted = Control::of(scope).laid(scope.plan, [picture, thick]);
    }
    painted = tone::curve(scope, painted);
    let saturation = scope.float("saturation");
    lab_to_rgb::pass(scope.plan, painted, saturation)
}
