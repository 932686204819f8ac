//! A blueprint: light lines on tinted paper (§ 1.2, 4.5).

use crate::declare::ports;
use crate::declare::spec::{NodeSpec, Param, STEADINESS, Scope, WINDOW};
use crate::declare::value::Value;
use crate::kernels::colour::blueprint_paper::{self, Drawing, Sheet};
use crate::kernels::colour::{lightness, rgb_to_lab};
use crate::stages::abstraction::{self, Abstraction};
use crate::stages::control::Control;
use crate::stages::line_sets::{self, Inked};
use crate::stages::lines::{SHOW, Show};
use crate::stages::steady::{Agreement, COLOUR_AGREEMENT, steadied};
use crate::stages::{
    ADVANCED, LOOK, difference_of_gaussians as dog, flow_dog, line_context, line_wobble, lines, paper,
};
use isophote_engine::ImageId;

/// The node.
pub static NODE: NodeSpec = NodeSpec {
    id: "blueprint",
    label: "Blueprint",
    group: "styles",
    hint: "Light lines on blue paper with a grid.",
    doc: "Light lines on blue paper with a grid: the flow-based difference of Gaussians of lightness and, \
          where given, of the breaks of normals, depth and object ids.",
    section: "1.2, 4.5",
    inputs: &[
        ports::COLOR,
        flow_dog::NORMAL,
        flow_dog::DEPTH,
        flow_dog::OBJECT_ID,
        line_wobble::REST_POSITION,
        ports::PAPER,
        ports::LINE_PAINT,
    ],
    output: ports::color_output("The blueprint."),
    own_params: &[
        lines::LINE_WIDTH,
        lines::LINE_AMOUNT,
        lines::SUPPRESS_SMALL,
        lines::OUTLINE_WIDTH,
        lines::BORDER_WIDTH,
        lines::CREASE_WIDTH,
        lines::FAR_WIDTH,
        lines::TEXTURE_LINES,
        line_wobble::WOBBLE,
        Param::color("line_color", "Line colour", [0.92, 0.96, 1.0, 1.0])
            .group(LOOK)
            .hint("Colour and opacity of the lines and the grid."),
        line_sets::LINE_COLORS,
        line_sets::OUTLINE_COLOR.with_default(Value::Color([1.0, 1.0, 1.0, 1.0])),
        line_sets::BORDER_COLOR.with_default(Value::Color([0.75, 0.86, 0.98, 1.0])),
        line_sets::CREASE_COLOR.with_default(Value::Color([0.5, 0.68, 0.92, 1.0])),
        Param::color("paper_color", "Paper colour", [0.0706, 0.251, 0.4824, 1.0])
            .group(LOOK)
            .hint("Colour of the paper."),
        Param::length("grid", "Grid", 32.0, [0.0, 4096.0])
            .slider(0.0, 128.0)
            .group(LOOK)
            .hint("Spacing of the grid, whose every fifth line is stronger; 0 for none."),
        Param::float("paper_texture", "Paper texture", 0.12, [0.0, 1.0])
            .group(LOOK)
            .hint("How rough the paper looks."),
        Param::float("fill", "Fill", 0.25, [0.0, 1.0])
            .group(LOOK)
            .hint("How much of the picture's tones shows on the paper."),
        abstraction::DETAIL,
        Param::bool("cover", "Opaque paper", false)
            .group(LOOK)
            .hint("Puts paper also where the picture is transparent.")
            .doc("The result is then opaque."),
        abstraction::ABSTRACTION,
        lines::N_E,
        abstraction::SIGMA_D,
        abstraction::SIGMA_R,
        dog::SIGMA_E.group(ADVANCED),
        dog::K.group(ADVANCED),
        flow_dog::SIGMA_M.group(ADVANCED),
        dog::TAU.with_default(Value::Float(0.98)).group(ADVANCED),
        dog::EPSILON.group(ADVANCED),
        dog::PHI.group(ADVANCED),
        lines::LINE_ITERATIONS,
        lines::GUIDE_WEIGHT,
        lines::NEAR,
        lines::FAR,
        line_sets::TAPER,
        line_sets::LINE_GAP,
        STEADINESS,
        WINDOW,
        line_wobble::HOLD,
        line_context::LOCAL_CONTRAST.with_default(Value::Float(1.0)).group(ADVANCED),
        line_context::INHIBITION.with_default(Value::Float(1.0)).group(ADVANCED),
        line_context::COLOUR_EDGES.group(ADVANCED),
        SHOW,
    ],
    build,
};

fn build(scope: &mut Scope<'_>) -> ImageId {
    let guide_weight = scope.float("guide_weight");
    let abstraction = Abstraction::of(scope);
    let n_e = scope.int("n_e");
    let flow = lines::flow_dog(scope, guide_weight);
    let [smooth, edges] = steadied(scope, Agreement::lab(COLOUR_AGREEMENT), |scope| {
        let color = scope.required("color");
        let guides = flow_dog::guides(scope, guide_weight);
        let tensor = lines::oriented(scope, guide_weight);
        let lab = rgb_to_lab::pass(scope.plan, color, 1.0);
        let control = Control::of(scope);
        let smooth = abstraction.apply(scope.plan, [lab, tensor], control, n_e);
        let lightness = lightness::pass_lab(scope.plan, smooth);
        let seen = flow_dog::Seen { lightness, lab: Some(smooth), control };
        [smooth, flow.edges(scope.plan, seen, tensor, &guides)]
    });
    let edges = line_sets::tapered(scope, &flow, edges, |scope| lines::oriented(scope, guide_weight));
    let edges = line_sets::gapped(scope, &flow, edges);
    let edges = line_wobble::wavering(scope, edges);
    let line = scope.color("line_color");
    let inked = Inked::new(scope, &flow, edges);
    if scope.option::<Show>(SHOW.id) == Show::Lines {
        let source = scope.required("color");
        let drawn = inked.over(scope, source);
        return lines::shown(scope, [drawn, source, inked.edges], inked.line[3]);
    }
    let lightness = lightness::pass_lab(scope.plan, smooth);
    let sheet = Sheet {
        line,
        paper: scope.color("paper_color"),
        spacing: scope.float("grid"),
        scale: scope.scale(),
        origin: scope.origin(),
        texture: scope.float("paper_texture"),
        fill: scope.float("fill"),
        cover: scope.bool("cover"),
    };
    let is_painted = inked.paint.is_some();
    let drawing = Drawing { lightness, edges: (!is_painted).then_some(edges), paper: paper::colours(scope) };
    let drawn = blueprint_paper::pass(scope.plan, &drawing, &sheet);
    if is_painted { inked.over(scope, drawn) } else { drawn }
}
