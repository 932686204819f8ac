//! Halftone printing (§ 1.2): tones as dots, lines, rings or squares of one ink, of four process inks or of two or three
//! spot colours, on paper.

mod inks;

use self::inks::{Inks, Press};
use crate::declare::ports;
use crate::declare::spec::{NodeSpec, Param, STEADINESS, Scope, WINDOW};
use crate::declare::value::Value;
use crate::kernels::colour::halftone_screen::{self, Print, Shape};
use crate::kernels::colour::{ink_separation, lightness, rgb_to_lab};
use crate::stages::abstraction::{self, Abstraction};
use crate::stages::control::Control;
use crate::stages::line_sets::Inked;
use crate::stages::steady::{Agreement, COLOUR_AGREEMENT, steadied};
use crate::stages::{
    ADVANCED, LOOK, difference_of_gaussians as dog, flow_dog, line_context, line_sets, lines, palette, tone,
};
use isophote_engine::ImageId;

/// The node.
pub static NODE: NodeSpec = NodeSpec {
    id: "halftone",
    label: "Halftone",
    group: "styles",
    hint: "Printed dots, lines, rings or squares in one ink, four process inks or spot colours.",
    doc: "Printed tones: the smoothed picture is separated into plates, and each is printed through a screen. Ink covers \
          the share of the paper that gives, seen from afar, the light of the picture against that of the paper, so \
          white stays paper and black is solid; light mixes linearly, not as encoded values. Tones are those of each \
          pixel, not of each cell, so that small things cut through dots. Lines, where asked for, are printed solid over \
          the screens, and outlines, creases and borders of objects follow normals, depth and object ids.",
    section: "1.2",
    inputs: &[ports::COLOR, flow_dog::NORMAL, flow_dog::DEPTH, flow_dog::OBJECT_ID, ports::LINE_PAINT],
    output: ports::color_output("The print."),
    own_params: &[
        Param::choice("shape", "Shape", Shape::Dots.selected())
            .uniform()
            .group(LOOK)
            .hint("What tones are printed as: dots, lines, rings around a point, or squares.")
            .doc("Dots and squares grow until they meet; from half the paper on dots are round holes in the ink."),
        Param::choice("inks", "Inks", Inks::Process.selected())
            .group(LOOK)
            .hint("What is printed with: one ink, four process inks, or two or three colours of your own.")
            .doc(
                "One ink prints lightness; where it is lighter than the paper it prints the lights. Four process inks \
                 print all colours. Two or three spot colours are fitted to each pixel's light by least squares, \
                 luminance above all: a dark one takes the shadows, the others what hue they share with the picture. \
                 Separation takes inks for transparent.",
            ),
        Param::length("cell", "Dot spacing", 8.0, [2.0, 256.0])
            .slider(3.0, 40.0)
            .group(LOOK)
            .hint("Distance from one dot or line to the next.")
            .doc("Where the rendered size leaves it less than two pixels, the screen fades to flat tones."),
        Param::float("angle", "Angle", 0.0, [-360.0, 360.0])
            .slider(-45.0, 60.0)
            .degrees()
            .group(LOOK)
            .hint("Turns the screens, counterclockwise: at 0 each ink has the angle that printers give it.")
            .doc("One ink and spot 1 lie at 45 degrees, as black does; cyan and spot 3 at 15, magenta and spot 2 at 75, yellow at 0. Rings have no angle."),
        Param::float("softness", "Softness", 0.0, [0.0, 1.0])
            .group(LOOK)
            .hint("How soft dots are: 0 is crisp, 1 runs from paper to ink."),
        Param::length("misregistration", "Misregistration", 0.0, [0.0, 64.0])
            .slider(0.0, 8.0)
            .structural()
            .group(LOOK)
            .hint("How far the plates of colours are printed beside the place where they belong.")
            .doc("Each plate moves in a direction of its own; black, spot 1 and a single ink stay."),
        Param::float("overprint", "Overprint", 1.0, [0.0, 1.0])
            .group(LOOK)
            .hint("How inks lie over each other: 1 lets them shine through, 0 lets the later one cover.")
            .doc("Transparent inks multiply the light of what lies below. The order is yellow, magenta, cyan, black, and spot 3, 2, 1."),
        Param::color("ink_color", "Ink colour", [0.09, 0.085, 0.1, 1.0])
            .group(LOOK)
            .hint("Colour of the only ink, and of the black one of four."),
        Param::color("spot_1", "Spot colour 1", [0.11, 0.15, 0.36, 1.0])
            .group(LOOK)
            .hint("The first colour of your own, as it looks on the paper: a dark one, for shadows."),
        Param::color("spot_2", "Spot colour 2", [0.93, 0.32, 0.27, 1.0])
            .group(LOOK)
            .hint("The second colour of your own, as it looks on the paper."),
        Param::color("spot_3", "Spot colour 3", [0.99, 0.81, 0.2, 1.0])
            .group(LOOK)
            .hint("The third colour of your own, as it looks on the paper, where there are three."),
        Param::color("paper_color", "Paper colour", [0.965, 0.95, 0.91, 1.0])
            .group(LOOK)
            .hint("Colour of the paper."),
        palette::PALETTE
            .hint("Prints with the paper and the inks of a palette, in the place of colours of your own.")
            .doc(
                "The lightest colour of the palette is the paper, and the darkest the only ink, the black one and spot 1. Spots 2 and 3 are \
                 those of the rest that differ most from all before them in CIELAB. Four process inks give way to three spots. \
                 Lines keep their colour.",
            ),
        Param::float("paper_texture", "Paper texture", 0.06, [0.0, 1.0])
            .group(LOOK)
            .hint("How rough the paper looks."),
        abstraction::DETAIL,
        tone::SATURATION,
        tone::LIGHTS,
        tone::DARKS,
        Param::bool("cover", "Opaque paper", false)
            .group(LOOK)
            .hint("Puts paper also where the picture is transparent.")
            .doc("The result is then opaque."),
        lines::LINE_WIDTH,
        lines::LINE_AMOUNT
            .with_default(Value::Float(0.0))
            .structural()
            .hint("How many solid lines are printed over the dots: 0 prints none and costs nothing, 1 draws faint edges too."),
        lines::SUPPRESS_SMALL,
        lines::OUTLINE_WIDTH,
        lines::BORDER_WIDTH,
        lines::CREASE_WIDTH,
        lines::FAR_WIDTH,
        lines::TEXTURE_LINES,
        Param::color("line_color", "Line colour", [0.09, 0.085, 0.1, 1.0])
            .group(LOOK)
            .hint("Colour and opacity of the lines."),
        abstraction::ABSTRACTION,
        abstraction::N_A.with_default(Value::Int(1)),
        abstraction::SIGMA_D,
        abstraction::SIGMA_R,
        Param::float("grey_replacement", "Black for grey", 0.7, [0.0, 1.0])
            .group(ADVANCED)
            .hint("How much of the grey that coloured inks would mix is printed by black instead.")
            .doc("Grey-component replacement, of four process inks: the share of 1 - max(R, G, B) of linear light."),
        Param::length("center_x", "Ring centre, across", 960.0, [-32768.0, 32768.0])
            .slider(0.0, 3840.0)
            .group(ADVANCED)
            .hint("Where the middle of the rings lies, from the left edge."),
        Param::length("center_y", "Ring centre, down", 540.0, [-32768.0, 32768.0])
            .slider(0.0, 2160.0)
            .group(ADVANCED)
            .hint("Where the middle of the rings lies, from the top edge."),
        lines::N_E,
        dog::SIGMA_E.group(ADVANCED),
        dog::K.group(ADVANCED),
        flow_dog::SIGMA_M.group(ADVANCED),
        // As in `cartoon`: dark textures do not fill with lines.
        dog::TAU.with_default(Value::Float(0.975)).group(ADVANCED),
        dog::EPSILON.group(ADVANCED),
        dog::PHI.group(ADVANCED),
        lines::LINE_ITERATIONS,
        lines::GUIDE_WEIGHT,
        lines::NEAR,
        lines::FAR,
        line_sets::TAPER,
        line_sets::LINE_GAP,
        line_context::LOCAL_CONTRAST.with_default(Value::Float(1.0)).group(ADVANCED),
        line_context::INHIBITION.with_default(Value::Float(1.0)).group(ADVANCED),
        line_context::COLOUR_EDGES.with_default(Value::Float(0.5)).group(ADVANCED),
        STEADINESS,
        WINDOW,
    ],
    build,
};

fn build(scope: &mut Scope<'_>) -> ImageId {
    let by = Agreement::lab(COLOUR_AGREEMENT);
    let guide_weight = scope.float(lines::GUIDE_WEIGHT.id);
    if scope.float(lines::LINE_AMOUNT.id) <= 0.0 {
        let [smooth] = steadied(scope, by, |scope| [smoothed(scope, guide_weight).0]);
        return printed(scope, smooth);
    }
    let flow = lines::flow_dog(scope, guide_weight);
    let n_e = scope.int(lines::N_E.id);
    let [smooth, edges] = steadied(scope, by, |scope| {
        let guides = flow_dog::guides(scope, guide_weight);
        let (smooth, lab, tensor) = smoothed(scope, guide_weight);
        let control = Control::of(scope);
        // The first iterations are those behind the tones: the plan records them once.
        let for_lines = Abstraction::of(scope).apply(scope.plan, [lab, tensor], control, n_e);
        let lightness = lightness::pass_lab(scope.plan, for_lines);
        let seen = flow_dog::Seen { lightness, lab: Some(for_lines), control };
        [smooth, flow.edges(scope.plan, seen, tensor, &guides)]
    });
    let print = printed(scope, smooth);
    let edges = line_sets::tapered(scope, &flow, edges, |scope| lines::oriented(scope, guide_weight));
    let edges = line_sets::gapped(scope, &flow, edges);
    Inked::new(scope, &flow, edges).over(scope, print)
}

/// The picture in CIELAB, smoothed and as it is, and the tensor that the smoothing follows.
fn smoothed(scope: &mut Scope<'_>, guide_weight: f32) -> (ImageId, ImageId, ImageId) {
    let color = scope.required("color");
    let tensor = lines::oriented(scope, guide_weight);
    let lab = rgb_to_lab::pass(scope.plan, color, 1.0);
    let n_a = scope.int(abstraction::N_A.id);
    let control = Control::of(scope);
    (Abstraction::of(scope).apply(scope.plan, [lab, tensor], control, n_a), lab, tensor)
}

/// A Lab image on paper.
fn printed(scope: &mut Scope<'_>, smooth: ImageId) -> ImageId {
    let toned = tone::curve(scope, smooth);
    let press = Press::of(scope);
    let shares = ink_separation::pass(scope.plan, toned, press.separation, scope.float("saturation"));
    let print = Print {
        plates: press.plates(),
        shape: scope.option("shape"),
        cell: scope.float("cell"),
        softness: scope.float("softness"),
        centre: [scope.float("center_x"), scope.float("center_y")],
        paper: press.paper,
        texture: scope.float("paper_texture"),
        cover: scope.bool("cover"),
        scale: scope.scale(),
        origin: scope.origin(),
    };
    halftone_screen::pass(scope.plan, shares, toned, &print)
}
