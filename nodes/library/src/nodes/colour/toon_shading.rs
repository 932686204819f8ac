//! Cel shading: light in steps, each with a colour of its own, on the colours of surfaces, as Lake et al. 2000 paint them by a
//! table of light; here of the layers of light that renderers write, or of a picture alone.

use crate::declare::ports;
use crate::declare::spec::{ImageKind, NodeSpec, Param, Port, STEADINESS, Scope, WINDOW};
use crate::kernels::colour::lab_to_rgb;
use crate::kernels::colour::toon_ramp::{Area, STEPS, Shading, Step};
use crate::kernels::smoothing::line_integral_convolution::{self, Options as Lic};
use crate::stages::light_steps::{self, BORDERS, Layers, NOWHERE, PLACES, TINTS};
use crate::stages::steady::{Agreement, COLOUR_AGREEMENT, compared, steadied};
use crate::stages::tensor_options::TensorOptions;
use crate::stages::{ADVANCED, LOOK, abstraction, line_integral_convolution as lic};
use isophote_engine::ImageId;

/// The node.
pub static NODE: NodeSpec = NodeSpec {
    id: "toon_shading",
    label: "Toon shading",
    group: "colour",
    hint: "Light in a few flat steps, each in a colour of its own, as cel animation is painted.",
    doc: "Light in steps on the colours of surfaces (Lake et al. 2000). Light is the luminance of `diffuse` over that of `albedo`, or of \
          the picture over that of `albedo` where there is no `diffuse`; without an albedo it is the luminance of \
          `diffuse`, and without both that of the picture, smoothed by the bilateral filter along the local structure; \
          surfaces then count as such that reflect 0.45 of it. Steps lie in its CIELAB lightness over 100, so that 1 \
          is a surface which shows its own colour. Each step multiplies the albedo, in linear light, by its colour: \
          white shows surfaces in their own colours. Without an albedo the picture's light is divided out of its \
          colours, and each step has a tone of its own. What no surface reflects, such as the sky and what glows, \
          stays as it is: what `diffuse` and `specular` leave of the picture where both are there, and otherwise what \
          has no albedo. Where `diffuse` is nothing and `specular` is something, as on metals, light is `specular`. \
          Borders are smooth steps at least a pixel and a half wide, by the gradient of the light.",
    section: "4.6",
    inputs: &[ports::COLOR, light_steps::ALBEDO, light_steps::DIFFUSE, light_steps::SPECULAR, NORMAL],
    output: ports::color_output("The shaded picture."),
    own_params: &[
        Param::int("steps", "Steps", 3, [1, STEPS as i32])
            .group(LOOK)
            .hint("Number of flat tones, from shadow to light. Steps above it have no effect."),
        light_steps::EXPOSURE,
        Param::float("softness", "Softness", 0.02, [0.0, 1.0])
            .slider(0.0, 0.5)
            .group(LOOK)
            .hint("Softness of the borders of all steps: 0 is as crisp as pixels allow."),
        COLORS[0].hint("Colour of the darkest step, the shadow; white leaves surfaces as they are."),
        COLORS[1],
        COLORS[2],
        COLORS[3],
        COLORS[4],
        COLORS[5],
        FROM[0],
        FROM[1],
        FROM[2],
        FROM[3],
        FROM[4],
        HIGHLIGHT,
        HIGHLIGHT_SIZE,
        HIGHLIGHT_SOFTNESS,
        HIGHLIGHT_COLOR,
        RIM,
        RIM_WIDTH,
        RIM_SOFTNESS,
        RIM_COLOR,
        abstraction::DETAIL,
        SOFTNESS[0],
        SOFTNESS[1],
        SOFTNESS[2],
        SOFTNESS[3],
        SOFTNESS[4],
        abstraction::ABSTRACTION,
        abstraction::N_A,
        abstraction::SIGMA_D,
        abstraction::SIGMA_R,
        SIGMA_A,
        STEADINESS,
        WINDOW,
    ],
    build,
};

const NORMAL: Port = Port {
    id: "normal",
    kind: ImageKind::Normal,
    optional: true,
    doc: "View-space normals, by which the rim is drawn.",
};

/// Ids and labels of the colours of the steps.
const COLOR_NAMES: [[&str; 2]; STEPS] = [
    ["color_1", "Step 1 colour"],
    ["color_2", "Step 2 colour"],
    ["color_3", "Step 3 colour"],
    ["color_4", "Step 4 colour"],
    ["color_5", "Step 5 colour"],
    ["color_6", "Step 6 colour"],
];

/// Ids and labels of the borders: place and softness of the step above.
const BORDER_NAMES: [[[&str; 2]; 2]; BORDERS] = [
    [["at_2", "Step 2 from"], ["softness_2", "Step 2 softness"]],
    [["at_3", "Step 3 from"], ["softness_3", "Step 3 softness"]],
    [["at_4", "Step 4 from"], ["softness_4", "Step 4 softness"]],
    [["at_5", "Step 5 from"], ["softness_5", "Step 5 softness"]],
    [["at_6", "Step 6 from"], ["softness_6", "Step 6 softness"]],
];

/// Colours of the steps.
const COLORS: [Param; STEPS] = [color(0), color(1), color(2), color(3), color(4), color(5)];
/// Places of the borders: the first step is wherever no other is.
const FROM: [Param; BORDERS] = [place(0), place(1), place(2), place(3), place(4)];
/// Softness of each border beside that of all.
const SOFTNESS: [Param; BORDERS] = [soft(0), soft(1), soft(2), soft(3), soft(4)];

const fn color(step: usize) -> Param {
    let [id, label] = COLOR_NAMES[step];
    Param::color(id, label, TINTS[step])
        .group(LOOK)
        .hint("Colour of this step; white leaves surfaces as they are. No effect with fewer steps.")
        .doc("Its opacity is not used.")
}

const fn place(border: usize) -> Param {
    let [id, label] = BORDER_NAMES[border][0];
    Param::float(id, label, PLACES[border], [0.0, 2.0])
        .slider(0.0, 1.5)
        .group(LOOK)
        .hint("Light from which on this step is: 0 is none, 1 shows surfaces in their own colours. No effect with fewer steps.")
        .doc("CIELAB lightness over 100. A step that begins below the one before it covers that.")
}

const fn soft(border: usize) -> Param {
    let [id, label] = BORDER_NAMES[border][1];
    Param::float(id, label, 0.0, [0.0, 1.0])
        .slider(0.0, 0.5)
        .group(ADVANCED)
        .hint(
            "Softness of the border where this step begins, beside that of all. No effect with fewer steps.",
        )
        .doc("Width of the border in light, added to `softness`.")
}

const HIGHLIGHT: Param = Param::float("highlight", "Highlight", 0.0, [0.0, 1.0])
    .group(LOOK)
    .hint("Strength of highlights with a shape of their own, from mirrored light where it is known.");
const HIGHLIGHT_SIZE: Param = Param::float("highlight_size", "Highlight size", 0.4, [0.0, 1.0])
    .group(LOOK)
    .hint("Size of highlights: 0 takes the brightest points alone.")
    .doc("They are where the lightness of mirrored light is above 1.2 less this.");
const HIGHLIGHT_SOFTNESS: Param = Param::float("highlight_softness", "Highlight softness", 0.05, [0.0, 1.0])
    .slider(0.0, 0.5)
    .group(ADVANCED)
    .hint("Softness of the borders of highlights.");
const HIGHLIGHT_COLOR: Param = Param::color("highlight_color", "Highlight colour", [1.0, 1.0, 0.97, 1.0])
    .group(LOOK)
    .hint("Colour and opacity of highlights.");
const RIM: Param = Param::float("rim", "Rim", 0.0, [0.0, 1.0])
    .group(LOOK)
    .hint("Strength of a band of light along outlines. Needs normals.");
const RIM_WIDTH: Param = Param::float("rim_width", "Rim width", 0.25, [0.0, 0.9])
    .group(LOOK)
    .hint("How far the band reaches onto round forms.")
    .doc("It is where 1 less the cosine between normal and view is above 1 less this.");
const RIM_SOFTNESS: Param = Param::float("rim_softness", "Rim softness", 0.08, [0.0, 1.0])
    .slider(0.0, 0.5)
    .group(ADVANCED)
    .hint("Softness of the inner border of the band.");
const RIM_COLOR: Param = Param::color("rim_color", "Rim colour", [1.0, 0.97, 0.9, 1.0])
    .group(LOOK)
    .hint("Colour and opacity of the band.");
const SIGMA_A: Param = Param::length("sigma_a", "Edge smoothing", 4.0, [0.0, 20.0])
    .slider(0.0, 10.0)
    .structural()
    .group(ADVANCED)
    .hint(
        "How far shapes of light are smoothed along their borders where they are found in the picture alone.",
    )
    .doc("Standard deviation of the smoothing along stream lines.");

/// Lightness of mirrored light above which highlights of size 0 are.
const BRIGHTEST: f32 = 1.2;

fn build(scope: &mut Scope<'_>) -> ImageId {
    let [_, shaded] = steadied(scope, Agreement::rgb(COLOUR_AGREEMENT), |scope| {
        let color = scope.required("color");
        [compared(scope, color), shaded(scope)]
    });
    shaded
}

/// The frame that is described in steps.
fn shaded(scope: &mut Scope<'_>) -> ImageId {
    let layers = Layers::of(scope);
    // Colours without light, and light: of a picture alone both are in its smooth regions.
    let surface = match layers.albedo {
        Some(albedo) => albedo,
        None => regions(scope),
    };
    let shading = shading(scope);
    let exposure = scope.float(light_steps::EXPOSURE.id);
    layers.shaded(scope.plan, surface, exposure, scope.int("steps") as usize, shading)
}

/// The picture without small differences, of smooth borders.
fn regions(scope: &mut Scope<'_>) -> ImageId {
    let options = TensorOptions::at_scale(scope.scale());
    let [mut smooth, tensors] = abstraction::regions(scope, &options, 1.0);
    let sigma = scope.float("sigma_a");
    if sigma > 0.0 {
        let along = Lic { sigma, ..lic::unadapted() };
        smooth = line_integral_convolution::pass_unadapted(scope.plan, smooth, tensors, &along);
    }
    lab_to_rgb::pass(scope.plan, smooth, 1.0)
}

/// The parameters as the kernel takes them.
fn shading(scope: &Scope<'_>) -> Shading {
    let count = scope.int("steps") as usize;
    let all = scope.float("softness");
    let mut steps = [Step { tint: [0.0; 3], from: 0.0, softness: 0.0 }; STEPS];
    for (at, step) in steps.iter_mut().enumerate() {
        let [r, g, b, _] = scope.color(COLORS[at].id);
        step.tint = [r, g, b];
        if let Some(border) = at.checked_sub(1) {
            step.from = if at < count { scope.float(FROM[border].id) } else { NOWHERE };
            step.softness = all + scope.float(SOFTNESS[border].id);
        }
    }
    let area = |id: &str, amount: &str, from: f32, softness: &str| {
        let [r, g, b, a] = scope.color(id);
        Area { colour: [r, g, b, a * scope.float(amount)], from, softness: scope.float(softness) }
    };
    let rim_from = 1.0 - scope.float("rim_width");
    let highlight_from = BRIGHTEST - scope.float("highlight_size");
    Shading {
        steps,
        rim: area("rim_color", "rim", rim_from, "rim_softness"),
        highlight: area("highlight_color", "highlight", highlight_from, "highlight_softness"),
    }
}
