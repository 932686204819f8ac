//! Ink and its relatives: the extended difference of Gaussians as drawing (§ 4.3, 4.4, Figure 4.1).

mod preset;

use self::preset::{Controls, GRAIN, Preset, Style, TONE};
use crate::declare::ports;
use crate::declare::spec::{HOLD, NodeSpec, Param, RENEWAL, STEADINESS, Scope, WINDOW};
use crate::declare::value::Value;
use crate::kernels::colour::composite_lines::{self, Params as Composite};
use crate::kernels::colour::ink_paint;
use crate::kernels::colour::ink_sheet::{self, Drawing, Sheet};
use crate::kernels::colour::light_on_dark::{self, Params as LightOnDark};
use crate::kernels::colour::tone_marks::{self, CROSSING, HATCHING, Hatching, Inputs, Tones};
use crate::kernels::colour::{hatching_tones, lab_to_rgb, lightness, rgb_to_lab, tone_relief};
use crate::kernels::lines::flow_dog_two_dimensional::Stepping;
use crate::kernels::shared::edge_threshold::{Threshold, Xdog};
use crate::kernels::shared::stream::{Integrator, STRETCH};
use crate::kernels::smoothing::gaussian_blur;
use crate::kernels::smoothing::line_integral_convolution::{self, Options as Lic};
use crate::kernels::structure::contrast;
use crate::kernels::structure::solid_noise::Marks;
use crate::kernels::structure::tensor_across;
use crate::kernels::structure::tensor_display::least_significant;
use crate::stages::abstraction::{self, Abstraction};
use crate::stages::control::Control;
use crate::stages::flow_dog::{self, FlowDog, Kernel, Seen};
use crate::stages::line_context::LineContext;
use crate::stages::line_on_dark::{MASSES_ON_DARK, MassesOnDark};
use crate::stages::lines::{SHOW, Show};
use crate::stages::steady::{Agreement, COLOUR_AGREEMENT, steadied};
use crate::stages::structure_tensor::of_color_and_guides;
use crate::stages::tensor_options::TensorOptions;
use crate::stages::{
    ADVANCED, LOOK, difference_of_gaussians as dog, flow_map, line_context, line_integral_convolution as lic,
    line_on_dark, line_sets, lines, marks, palette, paper, tone,
};
use isophote_engine::{Class, ImageId, math};

/// The node.
pub static NODE: NodeSpec = NodeSpec {
    id: "ink",
    label: "Ink",
    group: "styles",
    hint: "Drawings on paper, in pencil, ink, charcoal, woodcut or pastel.",
    doc: "Drawings on paper: pencil, ink, charcoal, woodcut or pastel. All are one filter, the flow-based \
          difference of Gaussians in its sharpening form (4.10), thresholded more or less softly (4.8), with \
          hatching, strokes along the form and the paper's grain, at five sets of values; `advanced` trims \
          them. What is light and empty stays bare paper. \
          Normals, depth and object ids, where given, draw lines of their own.",
    section: "4.3-4.5",
    inputs: &[
        ports::COLOR,
        flow_dog::NORMAL,
        flow_dog::DEPTH,
        flow_dog::OBJECT_ID,
        ports::REST_POSITION,
        ports::PAPER,
        ports::HATCHING,
        ports::LINE_PAINT,
    ],
    output: ports::color_output("The drawing."),
    own_params: &[
        Param::choice("style", "Medium", Style::Ink.selected())
            .group(LOOK)
            .hint("What is drawn with: pencil, ink, charcoal, woodcut or pastel.")
            .doc("Sets every technical value."),
        lines::LINE_WIDTH
            .hint("How thick lines are: 2 is the medium's own.")
            .doc("None is narrower than a pixel of the picture: it is lighter instead."),
        lines::LINE_AMOUNT
            .hint("How many lines there are: 0 leaves areas and shading alone, 1 draws faint edges too.")
            .doc("Scales p (4.10)."),
        lines::SUPPRESS_SMALL.doc("Lengthens the smoothing along lines by up to 0.8 of it and halves p."),
        lines::OUTLINE_WIDTH,
        lines::BORDER_WIDTH,
        lines::CREASE_WIDTH,
        lines::FAR_WIDTH,
        lines::TEXTURE_LINES,
        TONE,
        GRAIN,
        abstraction::DETAIL,
        Param::color("line_color", "Line colour", [0.09, 0.085, 0.1, 1.0])
            .group(LOOK)
            .hint("Colour and opacity of what is drawn with."),
        line_sets::LINE_COLORS,
        line_sets::OUTLINE_COLOR,
        line_sets::BORDER_COLOR,
        line_sets::CREASE_COLOR,
        Param::color("paper_color", "Paper colour", [0.965, 0.955, 0.93, 1.0])
            .group(LOOK)
            .hint("Colour of the paper."),
        tone::SATURATION
            .hint("Strength of the picture's own colours, as far as the medium shows them: 0 is grey."),
        palette::PALETTE,
        Param::bool("cover", "Opaque paper", false)
            .group(LOOK)
            .hint("Puts paper also where the picture is transparent.")
            .doc("The result is then opaque."),
        factor("edge_scale", "Edge scale", "Size of the edges that draw lines: 1 is the medium's own.")
            .doc("Factor on sigma_e (4.7)."),
        factor(
            "flow_length",
            "Line smoothing",
            "How far lines are smoothed along themselves: 1 is the medium's own.",
        )
        .doc("Factor on sigma_m (4.5)."),
        factor("sharpening", "Edge strength", "How strongly edges are brought out: 1 is the medium's own.")
            .doc("Factor on p (4.10)."),
        shift(
            "threshold_shift",
            "Ink level",
            100.0,
            "Puts ink on lighter tones above 0, and on fewer below.",
        )
        .doc("Added to epsilon, the lightness from which on there is no ink (4.8)."),
        factor("steepness", "Ink contrast", "How suddenly paper turns to ink: 1 is the medium's own.")
            .doc("Factor on phi (4.8)."),
        factor(
            "carving",
            "Carving",
            "How much of the hatching follows the form: 1 is the medium's own, 0 is regular.",
        )
        .doc("Factor on the share of the hatching that follows the form."),
        factor(
            "shading",
            "Shading",
            "How fast tones grow dark that are hatched or rubbed in: 1 is the medium's own.",
        ),
        factor(
            "hatch_spacing",
            "Hatch spacing",
            "Distance between the lines of the hatching: 1 is the medium's own.",
        ),
        factor("grain_size", "Grain size", "Size of the grain of the paper: 1 is the medium's own."),
        shift(
            "own_color",
            "Picture colours",
            1.0,
            "Shows more of the picture's own colours above 0, and less below.",
        ),
        factor("edge_smoothing", "Edge smoothing", "Last smoothing along the edges: 1 is the medium's own."),
        dog::K.group(ADVANCED),
        abstraction::ABSTRACTION,
        lines::N_E,
        abstraction::SIGMA_D,
        abstraction::SIGMA_R,
        lines::GUIDE_WEIGHT,
        lines::NEAR,
        lines::FAR,
        line_sets::TAPER,
        line_sets::LINE_GAP,
        STEADINESS,
        WINDOW,
        // Marks that are drawn anew do not fade.
        HOLD.structural(),
        RENEWAL,
        // Less than other styles have: shading draws masses of its own.
        line_context::LOCAL_CONTRAST.with_default(Value::Float(0.6)).group(ADVANCED),
        line_context::INHIBITION.with_default(Value::Float(1.0)).group(ADVANCED),
        line_context::COLOUR_EDGES.with_default(Value::Float(0.5)).group(ADVANCED),
        MASSES_ON_DARK.group(ADVANCED),
        factor(
            "hatch_bend",
            "Hatch bending",
            "How far regular hatching bends over the form: 1 is the medium's own, 0 is straight.",
        )
        .doc("Factor on the distance that hatches move aside per unit of L."),
        SHOW,
    ],
    build,
};

const fn factor(id: &'static str, label: &'static str, hint: &'static str) -> Param {
    Param::float(id, label, 1.0, [0.0, 4.0]).slider(0.0, 2.0).group(ADVANCED).hint(hint)
}

const fn shift(id: &'static str, label: &'static str, most: f32, hint: &'static str) -> Param {
    Param::float(id, label, 0.0, [-most, most]).group(ADVANCED).hint(hint)
}

/// Units of L above the ink's level that dark grounds count as where they draw no masses: as far from it as keeps noise out.
const BARE: f32 = 20.0;
/// Density of shading from which on lines are cut out of it, and that at which all are.
const MASS: f32 = 0.8;
const SOLID: f32 = 0.95;
/// Density of masses that are open.
const OPEN: f32 = 0.72;

/// Standard deviation of the further smoothing of the form that strokes lead across, and that of the relief over which
/// hatches bend, pixels of the full-size picture.
const WIDER: f32 = 5.0;
const RELIEF: f32 = 12.0;

/// Standard deviation of the window in which given hatching covers what its tone is, pixels of the full-size picture: some of
/// its strokes.
const DRAWN: f32 = 16.0;

/// Factor by which guides count more than where lightness is inhibited: here it counts in full, and light grounds are
/// far from ink.
const GUIDES: f32 = 1.7;

/// Anisotropy that noise exceeds in one of ten thousand places, in windows of standard deviation `rho` pixels (2.154, 2.158).
/// So few, because proxies, whose windows have fewer pixels, are to show the same marks.
fn significant(rho: f32) -> f32 {
    const SAMPLES: f32 = 4.0 * std::f32::consts::PI;
    least_significant(1e-4, SAMPLES * rho * rho)
}

/// Strokes along the flow, 0..=1 about middle grey, and the standard deviation of their values: noise, `width` pixels
/// wide and smoothed along the stream lines by `length`, lengths in pixels of the full-size picture; in steps stretched by
/// up to `stretch`.
fn strokes(
    scope: &mut Scope<'_>,
    tensor: ImageId,
    [width, length]: [f32; 2],
    stretch: f32,
) -> (ImageId, f32) {
    let (scale, seed) = (scope.scale(), scope.renewed(19));
    let soft = marks::grains(scope, width * scale, seed);
    let Marks { deviation, .. } = Marks::of_smoothed_noise(width * scale, scale, seed);
    // Noise is about as fine as pixels: steps are stretched where strokes are few enough not to show it.
    let options = Lic { sigma: length * scale, stretch, ..lic::options() };
    let long = line_integral_convolution::pass_unadapted(scope.plan, soft, tensor, &options);
    // A Gaussian along lines leaves this share of the deviation.
    let left = (width / math::hypot(length, width)).sqrt();
    const DEVIATION: f32 = 0.22;
    (contrast::pass(scope.plan, long, DEVIATION / (deviation * left)), DEVIATION)
}

/// The form that marks follow, whose directions turn gently: not each wrinkle of it.
fn gentle(scope: &mut Scope<'_>, tensor: ImageId, sigma: f32) -> ImageId {
    if sigma > 0.0 { gaussian_blur::pass(scope.plan, tensor, sigma, Class::Field) } else { tensor }
}

/// A Lab image, whose tones a hand has dragged along the form.
fn dragged(scope: &mut Scope<'_>, lab: ImageId, form: ImageId, sigma: f32) -> ImageId {
    if sigma <= 0.0 {
        return lab;
    }
    let options = Lic { sigma, stretch: STRETCH, ..lic::options() };
    line_integral_convolution::pass_unadapted(scope.plan, lab, form, &options)
}

/// Black lines on white, smoothed along the edges; in the second channel those that are cut out of dark masses, if there is
/// a lightness by which these are, and the range of it from bare paper to solid ones.
fn lines_on_white(
    scope: &mut Scope<'_>,
    color: ImageId,
    edges: ImageId,
    tensor: ImageId,
    sigma: f32,
    masses: Option<(ImageId, [f32; 2])>,
) -> ImageId {
    let (line, paper) = ([0.0, 0.0, 0.0, 1.0], [1.0; 4]);
    let drawn = match masses {
        None => composite_lines::pass(scope.plan, color, edges, &Composite { line, paper }),
        Some((lightness, [light, solid])) => {
            // Dark ones in the first channel, those that are cut out of masses in the second.
            let (line, cut) = ([0.0, 1.0, 1.0, 1.0], [1.0, 0.0, 1.0, 1.0]);
            let range = light - solid;
            let params = LightOnDark {
                line,
                light: cut,
                paper,
                dark: light - MASS * range,
                inverse: 1.0 / (SOLID - MASS) / range,
                padding: Default::default(),
            };
            let ground = line_on_dark::ground(scope, lightness);
            light_on_dark::pass(scope.plan, [color, edges, ground], &params)
        }
    };
    let options = Lic { sigma, ..lic::options() };
    line_integral_convolution::pass(scope.plan, drawn, tensor, &options)
}

/// The lines of a drawing.
fn flow(scope: &Scope<'_>, drawing: &Preset, guide_weight: f32) -> FlowDog {
    let scale = scope.scale();
    let sigma_e = drawing.sigma_e * scale;
    FlowDog {
        sigma_e,
        k: scope.float("k"),
        sigma_m: drawing.sigma_m * scale,
        xdog: Xdog::sharpen(drawing.p, drawing.epsilon, drawing.phi, Threshold::Tanh),
        iterations: 1,
        stepping: Stepping::Along(Integrator::TwoStep),
        kernel: Kernel::Separable,
        guide_weight: guide_weight * GUIDES,
        texture: scope.float(lines::TEXTURE_LINES.id),
        guided: lines::guided(scope, sigma_e),
        fades: true,
        context: context(scope, drawing),
        colour: scope.float(line_context::COLOUR_EDGES.id),
        distance: lines::distance(scope),
    }
    .on_pixels(scope)
}

/// Surroundings of lines. Where lines are to be seen in dark masses, shading alone draws these.
fn context(scope: &Scope<'_>, drawing: &Preset) -> LineContext {
    let context = LineContext::of(scope, scope.float(lines::TEXTURE_LINES.id));
    match scope.option(MASSES_ON_DARK.id) {
        MassesOnDark::Off => context,
        MassesOnDark::Light | MassesOnDark::Open => context.without_masses(drawing.epsilon + BARE),
    }
}

/// The paper of a drawing, and how its lines lie on it.
fn sheet(scope: &Scope<'_>, drawing: &Preset) -> Sheet {
    let mut line = scope.color("line_color");
    line[3] *= drawing.opacity;
    Sheet {
        line,
        paper: scope.color("paper_color"),
        follow: drawing.follow,
        grain: drawing.grain,
        grain_size: drawing.grain_size,
        dryness: drawing.dryness,
        cut: scope.option::<MassesOnDark>(MASSES_ON_DARK.id) == MassesOnDark::Light,
        scale: scope.scale(),
        origin: scope.origin(),
        colour: drawing.colour,
        ground: drawing.ground,
        texture: drawing.texture,
        cover: scope.bool("cover"),
        bare: scope.option::<Show>(SHOW.id) == Show::Lines,
    }
}

/// Marks that say the tones of a Lab image, along a form.
fn marked(scope: &mut Scope<'_>, drawing: &Preset, inputs: [ImageId; 2]) -> ImageId {
    let marks = toned(scope, drawing, inputs);
    Control::of(scope).marked(scope.plan, marks)
}

/// The same, as strong everywhere as the parameters say.
fn toned(scope: &mut Scope<'_>, drawing: &Preset, [lab, form]: [ImageId; 2]) -> ImageId {
    let scale = scope.scale();
    let (along, deviation) = strokes(scope, form, drawing.stroke, 1.0);
    let rules = rules(scope, drawing, deviation);
    if drawing.rubbed >= 1.0 {
        // Nothing is hatched, and what is rubbed in everywhere is not lifted out.
        let tones = tone_relief::pass(scope.plan, lab, lab);
        let inputs = Inputs { tones, tensor: form, strokes: along, crossing: along, hatching: Hatching::Own };
        return tone_marks::pass(scope.plan, &inputs, &rules);
    }
    let smeared = dragged(scope, lab, form, drawing.smear * scale);
    let relief = gaussian_blur::pass_colour(scope.plan, lab, RELIEF * scale);
    let tones = tone_relief::pass(scope.plan, smeared, relief);
    let hatching = hatching(scope, drawing);
    let crossing =
        if matches!(hatching, Hatching::Tones(_)) { along } else { crossing(scope, drawing, form) };
    let inputs = Inputs { tones, tensor: form, strokes: along, crossing, hatching };
    tone_marks::pass(scope.plan, &inputs, &rules)
}

/// Strokes across the form.
fn crossing(scope: &mut Scope<'_>, drawing: &Preset, form: ImageId) -> ImageId {
    let wider = gentle(scope, form, WIDER * scope.scale());
    let across = tensor_across::pass(scope.plan, wider);
    let [width, length] = drawing.stroke;
    strokes(scope, across, [width, length * CROSSING], STRETCH).0
}

/// Hatches of a drawing: those that are given, else those that move with things, else its own.
fn hatching(scope: &mut Scope<'_>, drawing: &Preset) -> Hatching {
    if let Some(given) = scope.input(ports::HATCHING.id) {
        let tones = hatching_tones::pass(scope.plan, given);
        let around = gaussian_blur::pass(scope.plan, tones, DRAWN * scope.scale(), Class::Field);
        return Hatching::Tones([tones, around]);
    }
    let noise = marks::hatching(scope, HATCHING, drawing.spacing, scope.renewed(301));
    noise.map_or(Hatching::Own, Hatching::Noise)
}

/// Rules by which tones become marks, with strokes of a standard deviation.
fn rules(scope: &Scope<'_>, drawing: &Preset, deviation: f32) -> Tones {
    let scale = scope.scale();
    let on_dark = scope.option::<MassesOnDark>(MASSES_ON_DARK.id);
    Tones {
        light: drawing.tones[0],
        solid: drawing.tones[1],
        ease: drawing.ease,
        most: if on_dark == MassesOnDark::Open { OPEN } else { 1.0 },
        rubbed: drawing.rubbed,
        form: drawing.form,
        spacing: drawing.spacing,
        bend: drawing.bend,
        lift: drawing.lift,
        significant: significant(math::hypot(drawing.rho, drawing.wide)),
        stroke: drawing.stroke.map(|length| length * scale),
        deviation,
        given_deviation: marks::HATCHING_DEVIATION,
        scale,
        origin: scope.origin(),
    }
}

/// What a frame shows by itself: the smoothed picture in Lab, its tensor, and its lines.
fn found(scope: &mut Scope<'_>, drawing: &Preset, flow: &FlowDog) -> [ImageId; 3] {
    let color = scope.required("color");
    let guides = flow_dog::guides(scope, scope.float("guide_weight"));
    let scale = scope.scale();
    let options = TensorOptions { rho: drawing.rho * scale, ..TensorOptions::at_scale(scale) };
    let tensor = of_color_and_guides(scope.plan, color, &guides, &options);
    let tensor = flow_map::bent(scope, tensor);
    let lab = rgb_to_lab::pass(scope.plan, color, 1.0);
    let iterations = scope.int("n_e") + drawing.flattening;
    let control = Control::of(scope);
    let smooth = Abstraction::of(scope).apply(scope.plan, [lab, tensor], control, iterations);
    let lightness = lightness::pass_lab(scope.plan, smooth);
    let seen = Seen { lightness, lab: Some(smooth), control };
    [smooth, tensor, flow.edges(scope.plan, seen, tensor, &guides)]
}

/// The same, steady over time, the form that marks follow, and the marks.
///
/// Marks fade from frame to frame where they belong to things and are not drawn anew. Those that motion carries alone are
/// made of layers that fade into one another already.
fn steady(scope: &mut Scope<'_>, drawing: &Preset, flow: &FlowDog) -> [ImageId; 5] {
    let by = Agreement::lab(COLOUR_AGREEMENT);
    let wide = drawing.wide * scope.scale();
    let is_given = scope.input(ports::HATCHING.id).is_some();
    if scope.input(ports::REST_POSITION.id).is_some() && scope.int(HOLD.id) == 0 && !is_given {
        let [smooth, tensor, edges, marks] = steadied(scope, by, |scope| {
            let [smooth, tensor, edges] = found(scope, drawing, flow);
            let form = gentle(scope, tensor, wide);
            [smooth, tensor, edges, marked(scope, drawing, [smooth, form])]
        });
        return [smooth, tensor, edges, gentle(scope, tensor, wide), marks];
    }
    let [smooth, tensor, edges] = steadied(scope, by, |scope| found(scope, drawing, flow));
    let form = gentle(scope, tensor, wide);
    [smooth, tensor, edges, form, marked(scope, drawing, [smooth, form])]
}

fn build(scope: &mut Scope<'_>) -> ImageId {
    let scale = scope.scale();
    let own = scope.option::<Style>("style").preset();
    let drawing = own.trimmed(scope).with_controls(Controls {
        width: scope.float("line_width") / scale,
        amount: scope.float("line_amount"),
        suppress: scope.float("suppress_small"),
        tone: scope.float("tone"),
        grain: scope.float("grain"),
    });
    let flow = flow(scope, &drawing, scope.float("guide_weight"));
    let [smooth, tensor, edges, form, marks] = steady(scope, &drawing, &flow);
    let edges = line_sets::tapered(scope, &flow, edges, |_| tensor);
    let edges = line_sets::gapped(scope, &flow, edges);
    // Where no own colour shows, saturation has no part in the plan, so that panels can tell.
    let saturation = if drawing.colour > 0.0 { scope.float("saturation") } else { 1.0 };
    let tinted = lab_to_rgb::pass(scope.plan, smooth, saturation);
    let toned = lightness::pass_lab(scope.plan, smooth);
    let on_dark = scope.option::<MassesOnDark>(MASSES_ON_DARK.id);
    let masses = (on_dark == MassesOnDark::Light).then_some((toned, drawing.tones));
    let lines = lines_on_white(scope, tinted, edges, tensor, drawing.sigma_a * scale, masses);
    // Where all grain is the paper's, none of it is read.
    let strokes = if drawing.follow > 0.0 { strokes(scope, form, drawing.stroke, 1.0).0 } else { tinted };
    let (sheet, opacity) = (sheet(scope, &drawing), drawing.opacity);
    let paper = paper::given(scope);
    let paint = line_sets::paint(scope, &flow, opacity, sheet.line);
    let painted = paint.is_some();
    let lines = paint.map_or(lines, |paint| ink_paint::pass(scope.plan, [lines, paint], sheet.cut));
    let drawing = Drawing { lines, painted, color: tinted, strokes, marks, tones: toned, paper };
    let sheet = ink_sheet::pass(scope.plan, &drawing, &sheet);
    palette::ended(scope, sheet)
}
