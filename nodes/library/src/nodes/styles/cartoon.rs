//! The enhanced cartoon filter (§ 4.6, Fig. 4.7).

use crate::declare::choice::choice;
use crate::declare::ports;
use crate::declare::spec::{NodeSpec, Param, STEADINESS, Scope, WINDOW};
use crate::declare::value::Value;
use crate::kernels::colour::{lab_to_rgb, lightness, rgb_to_lab};
use crate::kernels::smoothing::line_integral_convolution::{self, Options as Lic};
use crate::stages::abstraction::{self, Abstraction};
use crate::stages::cel_light::Tones;
use crate::stages::control::Control;
use crate::stages::line_on_dark::{LINE_ON_DARK, OnDark};
use crate::stages::line_sets::{self, Inked};
use crate::stages::steady::{Agreement, COLOUR_AGREEMENT, steadied};
use crate::stages::tensor_options::Guides;
use crate::stages::{
    ADVANCED, LOOK, ben_day, cel_light, difference_of_gaussians as dog, flow_dog, light_steps, line_context,
    line_integral_convolution as lic, line_on_dark, line_wobble, lines, palette, quantization as levels,
    quantize_luminance as quantization, tone, warp_sharpen,
};
use isophote_engine::{ImageId, PlanBuilder};

/// The node.
pub static NODE: NodeSpec = NodeSpec {
    id: "cartoon",
    label: "Cartoon",
    group: "styles",
    hint: "Flat colours, a few tones and flowing black lines.",
    doc: "Flattened colours and coherent black lines: bilateral filtering in CIELAB along the local \
          structure, lines by the flow-based difference of Gaussians, soft quantization of lightness. \
          Defaults are those of Fig. 4.8, but for `tau`, and for steps of lightness, which are crisp and lie \
          only where tones change. Normals, depth and object ids, where given, draw lines of \
          their own; albedo, diffuse and mirrored light can be cut into steps of light in the place of lightness.",
    section: "4.6",
    inputs: &[
        ports::COLOR,
        flow_dog::NORMAL,
        flow_dog::DEPTH,
        flow_dog::OBJECT_ID,
        line_wobble::REST_POSITION,
        light_steps::ALBEDO,
        light_steps::DIFFUSE,
        light_steps::SPECULAR,
        ports::LINE_PAINT,
    ],
    output: ports::color_output("The cartoon."),
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
        LINE_COLOR,
        line_sets::LINE_COLORS,
        line_sets::OUTLINE_COLOR.with_default(Value::Color([0.0, 0.0, 0.0, 1.0])),
        line_sets::BORDER_COLOR,
        line_sets::CREASE_COLOR,
        abstraction::DETAIL,
        levels::POSTERIZE,
        levels::POSTERIZE_SMOOTH,
        levels::STEPS.with_default(levels::BY_AREA).group(LOOK),
        tone::SATURATION,
        tone::LIGHTS,
        tone::DARKS,
        palette::PALETTE,
        ben_day::DOTS,
        ben_day::DOT_SPACING,
        cel_light::SHADING,
        cel_light::LIGHT_STEPS,
        cel_light::LIGHT,
        cel_light::SHADOW_COLOR,
        cel_light::MIDDLE_COLOR,
        cel_light::LIGHT_COLOR,
        abstraction::ABSTRACTION,
        LINE_FILTER,
        lines::N_E,
        Param::int("n_a", "Smoothing rounds", 4, [0, 16])
            .slider(0.0, 8.0)
            .structural()
            .group(ADVANCED)
            .hint("How often the colours are smoothed: more rounds give flatter areas.")
            .doc("Bilateral iterations behind the colours (n_a)."),
        abstraction::SIGMA_D,
        abstraction::SIGMA_R,
        dog::SIGMA_E.group(ADVANCED),
        dog::K.group(ADVANCED),
        flow_dog::SIGMA_M.group(ADVANCED),
        // Less inhibition than Fig. 4.8 has: dark textures do not fill with lines.
        dog::TAU.with_default(Value::Float(0.975)).group(ADVANCED),
        dog::EPSILON.group(ADVANCED),
        dog::PHI.group(ADVANCED),
        lines::LINE_ITERATIONS,
        lines::GUIDE_WEIGHT,
        lines::NEAR,
        lines::FAR,
        line_sets::TAPER,
        line_sets::LINE_GAP,
        // Crisper steps than those of Fig. 4.8, where there is something that they follow.
        quantization::PHI_Q.with_default(Value::Float(8.0)).group(ADVANCED),
        quantization::ADAPTIVE.with_default(Value::Bool(false)).group(ADVANCED),
        quantization::LAMBDA_DELTA.group(ADVANCED),
        quantization::OMEGA_DELTA.group(ADVANCED),
        quantization::LAMBDA_PHI.group(ADVANCED),
        quantization::OMEGA_PHI.group(ADVANCED),
        quantization::LEAST_GRADIENT.with_default(Value::Float(0.2)).group(ADVANCED),
        WARP,
        SIGMA_A,
        STEADINESS,
        WINDOW,
        line_wobble::HOLD,
        line_context::LOCAL_CONTRAST.with_default(Value::Float(1.0)).group(ADVANCED),
        line_context::INHIBITION.with_default(Value::Float(1.0)).group(ADVANCED),
        line_context::COLOUR_EDGES.with_default(Value::Float(0.5)).group(ADVANCED),
        LINE_ON_DARK.group(ADVANCED),
        lines::SHOW,
    ],
    build,
};

const LINE_COLOR: Param = Param::color("line_color", "Line colour", [0.0, 0.0, 0.0, 1.0])
    .group(LOOK)
    .hint("Colour and opacity of the lines.");
const SIGMA_A: Param = Param::length("sigma_a", "Edge smoothing", 1.5, [0.0, 20.0])
    .slider(0.0, 5.0)
    .structural()
    .group(ADVANCED)
    .hint("Last smoothing along the edges, against jagged steps and lines; 0 for none.")
    .doc("Standard deviation of the final smoothing along the edges.");

const LINE_FILTER: Param = Param::choice("line_filter", "Line method", LineFilter::Flow.selected())
    .group(ADVANCED)
    .hint("Lines that flow along the forms, or plain ones, for which normals, depth and object ids do not count.").doc(
        "How lines are found: across and along the local orientation (4.5), or in all directions alike (4.2), where \
         `sigma_m` has no part and guides draw no lines.",
    );
const WARP: Param = Param::length("warp", "Edge pull", 0.0, [0.0, 20.0])
    .slider(0.0, 6.0)
    .structural()
    .group(ADVANCED)
    .hint("How far colours are pulled towards sharp edges, which narrows blurred ones; 0 for not at all.")
    .doc("The pull comes before lines are drawn (phi_w of `warp_sharpen`).");

choice! {
    /// Filter by which lines are found.
    enum LineFilter {
        /// Lines that flow along the forms.
        Flow ("flow", "Flowing"),
        /// Plain lines, found in all directions alike.
        Isotropic ("isotropic", "Plain"),
    }
}

fn build(scope: &mut Scope<'_>) -> ImageId {
    let guide_weight = scope.float("guide_weight");
    let abstraction = Abstraction::of(scope);
    let (n_e, n_a) = (scope.int("n_e"), scope.int("n_a"));
    let line_filter = scope.option("line_filter");
    let flow = match line_filter {
        LineFilter::Flow => lines::flow_dog(scope, guide_weight),
        // Guides draw no lines.
        LineFilter::Isotropic => lines::flow_dog(scope, 0.0),
    };
    let by = Agreement::lab(COLOUR_AGREEMENT);
    let [smooth, edges, flat] = steadied(scope, by, |scope| {
        let color = scope.required("color");
        let guides = flow_dog::guides(scope, guide_weight);
        let tensor = lines::oriented(scope, guide_weight);
        let lab = rgb_to_lab::pass(scope.plan, color, 1.0);
        let control = Control::of(scope);
        // The first iterations are those behind the lines: the plan records them once.
        let smooth = abstraction.apply(scope.plan, [lab, tensor], control, n_a);
        let for_lines = abstraction.apply(scope.plan, [lab, tensor], control, n_e);
        let lightness = lightness::pass_lab(scope.plan, for_lines);
        let edges = match line_filter {
            LineFilter::Flow => {
                let seen = flow_dog::Seen { lightness, lab: Some(for_lines), control };
                flow.edges(scope.plan, seen, tensor, &guides)
            }
            LineFilter::Isotropic => flow.isotropic(scope.plan, lightness),
        };
        let flat = match scope.option(cel_light::SHADING.id) {
            Tones::Lightness => flattened(scope, smooth),
            Tones::Light => {
                lit(scope, smooth, |plan, lab| abstraction.apply(plan, [lab, tensor], control, n_a))
            }
        };
        [smooth, edges, flat]
    });

    let mut rgb = lab_to_rgb::pass(scope.plan, flat, scope.float("saturation"));
    let warp = scope.float("warp");
    if warp > 0.0 {
        let sigma = warp_sharpen::SIGMA_W.default_float() * scope.scale();
        rgb = warp_sharpen::warped(scope.plan, rgb, sigma, warp);
    }
    let edges = line_sets::tapered(scope, &flow, edges, |scope| lines::oriented(scope, guide_weight));
    let edges = line_sets::gapped(scope, &flow, edges);
    let edges = line_wobble::wavering(scope, edges);
    let inked = Inked::new(scope, &flow, edges);
    let drawn = lined(scope, [rgb, smooth], inked, flow.guide_weight);
    let mut drawn = lines::shown(scope, [drawn, rgb, inked.edges], inked.line[3]);
    let sigma_a = scope.float("sigma_a");
    if sigma_a > 0.0 {
        let smooth = Lic { sigma: sigma_a, ..lic::unadapted() };
        // That of the frame itself, which is there: averages of neighbours would lead the smoothing hardly elsewhere.
        let tensor = lines::oriented(scope, guide_weight);
        drawn = line_integral_convolution::pass_unadapted(scope.plan, drawn, tensor, &smooth);
    }
    // Last: smoothing along the edges would draw the dots out. Lines are kept out of them.
    let printed = ben_day::printed(scope, drawn, inked.edges, inked.line[3]);
    palette::ended(scope, printed)
}

/// A smoothed picture in few flat tones, in Lab.
fn flattened(scope: &mut Scope<'_>, smooth: ImageId) -> ImageId {
    let toned = tone::curve(scope, smooth);
    match scope.int("posterize") {
        0 => toned,
        bins => levels::flattened(scope, toned, bins, levels::steepness(scope, bins)),
    }
}

/// A smoothed picture in steps of light, in Lab; `smoothed` smooths the colours of surfaces alike.
fn lit(
    scope: &mut Scope<'_>,
    smooth: ImageId,
    smoothed: impl FnOnce(&mut PlanBuilder, ImageId) -> ImageId,
) -> ImageId {
    let lit = cel_light::shaded(scope, smooth, smoothed);
    tone::curve(scope, lit)
}

/// A picture with its lines, of which those turn light that lie on dark tones, as `smooth` in Lab has them before they are
/// flattened: a step between them is no reason to turn.
fn lined(scope: &mut Scope<'_>, [rgb, smooth]: [ImageId; 2], inked: Inked, guide_weight: f32) -> ImageId {
    match scope.option(LINE_ON_DARK.id) {
        OnDark::Off => inked.over(scope, rgb),
        OnDark::Light => {
            let guided = flow_dog::guides(scope, guide_weight) != Guides::default();
            let toned = tone::curve(scope, smooth);
            let lightness = lightness::pass_lab(scope.plan, toned);
            let Some(paint) = inked.paint else {
                return line_on_dark::drawn(scope, [rgb, inked.edges, lightness], inked.line, guided);
            };
            let paint = line_on_dark::painted(scope, [paint, rgb, lightness], guided);
            Inked { paint: Some(paint), ..inked }.over(scope, rgb)
        }
    }
}
