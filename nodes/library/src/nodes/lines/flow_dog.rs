//! The flow-based difference of Gaussians filter (§ 4.5), separable or with its two-dimensional kernel, with
//! lines where geometry breaks.

use crate::declare::choice::choice;
use crate::declare::ports;
use crate::declare::spec::{CONTROL, NodeSpec, Param, STEADINESS, Scope, WINDOW};
use crate::kernels::colour::{lightness, rgb_to_lab};
use crate::kernels::lines::flow_dog_two_dimensional::Stepping;
use crate::kernels::shared::stream::Integrator;
use crate::stages::control::Control;
use crate::stages::flow_dog::{
    DEPTH, Distance, FlowDog, Guided, Kernel, NORMAL, OBJECT_ID, SIGMA_M, Seen, guides, tensor,
};
use crate::stages::line_context::{COLOUR_EDGES, INHIBITION, LOCAL_CONTRAST, LineContext};
use crate::stages::steady::{Agreement, COLOUR_AGREEMENT, compared, steadied};
use crate::stages::{ADVANCED, difference_of_gaussians as dog};
use isophote_engine::ImageId;

/// The node.
pub static NODE: NodeSpec = NodeSpec {
    id: "flow_dog",
    label: "Flowing lines",
    group: "lines",
    hint: "Long clean lines that flow along the forms, also at creases and outlines of objects: white is paper, black is line.",
    doc: "Coherent lines: a difference of Gaussians across the edges, smoothed along them (Listing 4.1). \
          Where normals, depth or object ids are given and `guide_weight` is above 0, lines are also \
          drawn where these break, along the same flow. 1 is paper, 0 is line.",
    section: "4.5",
    inputs: &[ports::COLOR, ports::TENSOR, NORMAL, DEPTH, OBJECT_ID, CONTROL],
    output: dog::EDGES,
    own_params: &[
        dog::SIGMA_E,
        dog::K,
        SIGMA_M,
        dog::FORM,
        dog::TAU,
        dog::EPSILON,
        dog::PHI,
        dog::P,
        dog::EPSILON_P,
        dog::PHI_P,
        dog::THRESHOLD,
        Param::int("iterations", "Rounds", 1, [1, 16]).slider(1.0, 5.0).structural().hint("How often lines are looked for, each time on top of those found, which closes gaps.").doc(
            "Times the filter runs, each on the lightness times the lines found so far, which closes gaps.",
        ),
        KERNEL,
        INTEGRATOR,
        Param::float("guide_weight", "Guide strength", 0.0, [0.0, 16.0])
            .slider(0.0, 2.0)
            .structural()
            .hint("Strength of the lines that normals, depth and object ids draw; 0 leaves these out.").doc("Strength of lines where normal, depth or object id break; 0 leaves the guides unread."),
        STEADINESS,
        WINDOW,
        LOCAL_CONTRAST.group(ADVANCED),
        INHIBITION.group(ADVANCED),
        COLOUR_EDGES.group(ADVANCED),
    ],
    build,
};

const INTEGRATOR: Param = Param::choice("integrator", "Line tracing", Tracing::Midpoint.selected()).hint("How lines are followed: simply and fast, or more exactly.").doc(
    "How stream lines are stepped: Euler (2.176), second order (2.182), from pixel boundary to pixel \
     boundary with the Gaussian integrated exactly (Cabral and Leedom, 2.193), or second order with the tangent \
     here extrapolated from the last steps, which takes less time.",
);
const KERNEL: Param = Param::choice("kernel", "Precision", Kernel::Separable.selected()).hint("Fast, or thorough, which takes long and hardly looks different.").doc(
    "Separable: across the tangent at each pixel, then along its stream line. Two-dimensional: across the \
     tangent at every point of the stream line, as first proposed; costly, and hardly different to the eye.",
);

choice! {
    /// Method by which stream lines are stepped.
    enum Tracing {
        /// Euler's method.
        Euler ("euler", "Simple"),
        /// The midpoint method, a second-order Runge-Kutta method.
        Midpoint ("rk2", "Exact"),
        /// From pixel boundary to pixel boundary, the method of Cabral and Leedom.
        CabralLeedom ("cabral_leedom", "Pixel by pixel"),
        /// The midpoint method with an extrapolated tangent, as exact and faster.
        TwoStep ("two_step", "Exact, faster"),
    }
}

fn build(scope: &mut Scope<'_>) -> ImageId {
    let sigma_e = scope.float("sigma_e");
    let lines = FlowDog {
        sigma_e,
        k: scope.float("k"),
        sigma_m: scope.float("sigma_m"),
        xdog: dog::xdog(scope),
        iterations: scope.int("iterations"),
        stepping: match scope.option("integrator") {
            Tracing::Euler => Stepping::Along(Integrator::Euler),
            Tracing::Midpoint => Stepping::Along(Integrator::Midpoint),
            Tracing::TwoStep => Stepping::Along(Integrator::TwoStep),
            Tracing::CabralLeedom => Stepping::CabralLeedom,
        },
        kernel: scope.option("kernel"),
        guide_weight: scope.float("guide_weight"),
        texture: 1.0,
        guided: [Guided::new(sigma_e); 3],
        fades: dog::fades(scope),
        context: LineContext::of(scope, 1.0),
        colour: scope.float(COLOUR_EDGES.id),
        distance: Distance::NONE,
    }
    .on_pixels(scope);
    let guides_of = |scope: &Scope<'_>| guides(scope, lines.guide_weight);
    let guides = guides_of(scope);
    let by = Agreement::rgb(COLOUR_AGREEMENT);
    let [_, color, tensor] = steadied(scope, by, |scope| {
        let color = scope.required("color");
        let guides = guides_of(scope);
        let found = scope.input("tensor").unwrap_or_else(|| tensor(scope, color, &guides));
        [compared(scope, color), color, found]
    });
    let lightness = lightness::pass(scope.plan, color);
    let lab = (lines.colour > 0.0).then(|| rgb_to_lab::pass(scope.plan, color, 1.0));
    let control = Control::of(scope);
    lines.edges(scope.plan, Seen { lightness, lab, control }, tensor, &guides)
}
