//! The flow-based difference of Gaussians filter (§ 4.5), separable or with its two-dimensional kernel, with
//! lines where geometry breaks.

use crate::declare::choice::choice;
use crate::declare::ports;
use crate::declare::spec::{NodeSpec, Param, STEADINESS, Scope, WINDOW};
use crate::kernels::colour::lightness;
use crate::kernels::lines::flow_dog_two_dimensional::Stepping;
use crate::kernels::shared::stream::Integrator;
use crate::stages::difference_of_gaussians as dog;
use crate::stages::flow_dog::{DEPTH, FlowDog, Guided, Kernel, NORMAL, OBJECT_ID, SIGMA_M, guides, tensor};
use crate::stages::steady::{Agreement, COLOUR_AGREEMENT, Steadied, compared, steadied};
use isophote_engine::ImageId;

/// The node.
pub static NODE: NodeSpec = NodeSpec {
    id: "flow_dog",
    label: "Flow-based difference of Gaussians",
    group: "lines",
    doc: "Coherent lines: a difference of Gaussians across the edges, smoothed along them (Listing 4.1). \
          Where normals, depth or object ids are given and `guide_weight` is above 0, lines are also \
          drawn where these break, along the same flow. 1 is paper, 0 is line.",
    section: "4.5",
    inputs: &[ports::COLOR, ports::TENSOR, NORMAL, DEPTH, OBJECT_ID],
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
        Param::int("iterations", "Iterations", 1, [1, 16]).slider(1.0, 5.0).structural().doc(
            "Times the filter runs, each on the lightness times the lines found so far, which closes gaps.",
        ),
        KERNEL,
        INTEGRATOR,
        Param::float("guide_weight", "Guide weight", 0.0, [0.0, 16.0])
            .slider(0.0, 2.0)
            .structural()
            .doc("Strength of lines where normal, depth or object id break; 0 leaves the guides unread."),
        STEADINESS,
        WINDOW,
    ],
    build,
};

const INTEGRATOR: Param = Param::choice("integrator", "Integrator", Tracing::Midpoint.selected()).doc(
    "How stream lines are stepped: Euler (2.176), second order (2.182), from pixel boundary to pixel \
     boundary with the Gaussian integrated exactly (Cabral and Leedom, 2.193), or second order with the tangent \
     here extrapolated from the last steps, which takes less time.",
);
const KERNEL: Param = Param::choice("kernel", "Kernel", Kernel::Separable.selected()).doc(
    "Separable: across the tangent at each pixel, then along its stream line. Two-dimensional: across the \
     tangent at every point of the stream line, as first proposed; costly, and hardly different to the eye.",
);

choice! {
    /// Method by which stream lines are stepped.
    enum Tracing {
        /// Euler's method (2.176).
        Euler ("euler", "Euler"),
        /// The midpoint method, a second-order Runge-Kutta method (2.182).
        Midpoint ("rk2", "Runge-Kutta, second order"),
        /// From pixel boundary to pixel boundary, with the Gaussian integrated exactly (2.193).
        CabralLeedom ("cabral_leedom", "Cabral-Leedom"),
        /// The midpoint method with an extrapolated tangent, of second order too and faster.
        TwoStep ("two_step", "Two-step midpoint, second order"),
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
        guided: [Guided::new(sigma_e); 2],
        fades: dog::fades(scope),
    }
    .on_pixels(scope);
    let guides_of = |scope: &Scope<'_>| guides(scope, lines.guide_weight);
    let guides = guides_of(scope);
    let by = Agreement::rgb(COLOUR_AGREEMENT);
    let Steadied { stages: [_, color, tensor], .. } = steadied(scope, by, |scope| {
        let color = scope.required("color");
        let guides = guides_of(scope);
        let found = scope.input("tensor").unwrap_or_else(|| tensor(scope, color, &guides));
        [compared(scope, color), color, found]
    });
    let lightness = lightness::pass(scope.plan, color);
    lines.edges(scope.plan, lightness, tensor, &guides)
}
