//! The enhanced cartoon filter (§ 4.6, Fig. 4.7).

use crate::kernels::colour::quantize_luminance::{Steepness, quantize};
use crate::kernels::colour::{composite_lines, lab_to_rgb, lightness, rgb_to_lab, tone_curve};
use crate::kernels::lines::flow_dog_two_dimensional::Stepping;
use crate::kernels::shared::stream::Integrator;
use crate::kernels::smoothing::bilateral::Options;
use crate::kernels::smoothing::line_integral_convolution::{self, Options as Lic};
use crate::look::{self, ADVANCED, Lines};
use crate::nodes::colour::quantize_luminance as quantization;
use crate::nodes::lines::difference_of_gaussians as dog;
use crate::nodes::lines::flow_dog::{self, FlowDog};
use crate::nodes::smoothing::{bilateral, flow_bilateral, oriented_bilateral};
use crate::ports;
use crate::spec::{Choice, NodeSpec, Param, Scope};
use isophote_engine::{ImageId, PlanBuilder};

/// The node.
pub static NODE: NodeSpec = NodeSpec {
    id: "cartoon",
    label: "Cartoon",
    group: "styles",
    doc: "Flattened colours and coherent black lines: bilateral filtering in CIELAB along the local \
          structure, lines by the flow-based difference of Gaussians, soft quantization of lightness. \
          Defaults are those of Fig. 4.8. Normals, depth and object ids, where given, draw lines of \
          their own.",
    section: "4.6",
    inputs: &[ports::COLOR, flow_dog::NORMAL, flow_dog::DEPTH, flow_dog::OBJECT_ID],
    output: ports::color_output("The cartoon."),
    own_params: &[
        look::LINE_WIDTH,
        look::LINE_AMOUNT,
        look::SUPPRESS_SMALL,
        LINE_COLOR,
        look::DETAIL,
        look::POSTERIZE,
        look::POSTERIZE_SMOOTH,
        look::SATURATION,
        look::LIGHTS,
        look::DARKS,
        ABSTRACTION,
        N_E,
        Param::int("n_a", "Iterations for colour", 4, [0, 16])
            .slider(0.0, 8.0)
            .structural()
            .group(ADVANCED)
            .doc("Bilateral iterations behind the colours (n_a)."),
        SIGMA_D,
        SIGMA_R,
        dog::SIGMA_E.group(ADVANCED),
        dog::K.group(ADVANCED),
        flow_dog::SIGMA_M.group(ADVANCED),
        dog::TAU.group(ADVANCED),
        dog::EPSILON.group(ADVANCED),
        dog::PHI.group(ADVANCED),
        LINE_ITERATIONS,
        GUIDE_WEIGHT,
        quantization::PHI_Q.group(ADVANCED),
        Param::bool("adaptive", "Adaptive quantization", false)
            .group(ADVANCED)
            .doc("Steepness from the gradient of L instead of `phi_q`, for steady sequences."),
        quantization::LAMBDA_DELTA.group(ADVANCED),
        quantization::OMEGA_DELTA.group(ADVANCED),
        quantization::LAMBDA_PHI.group(ADVANCED),
        quantization::OMEGA_PHI.group(ADVANCED),
        SIGMA_A,
    ],
    build,
};

const LINE_COLOR: Param = Param::color("line_color", "Line colour", [0.0, 0.0, 0.0, 1.0])
    .group(look::LOOK)
    .doc("Colour of the lines; its alpha is their opacity.");
pub(crate) const ABSTRACTION: Param = Param::choice(
    "abstraction",
    "Abstraction",
    0,
    &[
        Choice { id: "oriented", label: "Oriented bilateral" },
        Choice { id: "flow", label: "Flow bilateral" },
        Choice { id: "full", label: "Full bilateral" },
        Choice { id: "xy", label: "Separable bilateral" },
    ],
)
.group(ADVANCED)
.doc(
    "Bilateral filter: across and along the local orientation (3.4), or along stream lines (3.5), whose \
     own scales then grow with `sigma_d` / 3 and `sigma_r` / 4.25; or without regard to it, by the full \
     window (3.2) or along rows and then columns (3.3).",
);
pub(crate) const N_E: Param = Param::int("n_e", "Iterations for lines", 1, [0, 16])
    .slider(0.0, 8.0)
    .structural()
    .group(ADVANCED)
    .doc("Bilateral iterations before lines are extracted (n_e), which keeps noise out of them.");
pub(crate) const SIGMA_D: Param = Param::float("sigma_d", "Sigma d", 3.0, [0.1, 20.0])
    .slider(0.5, 10.0)
    .pixels()
    .group(ADVANCED)
    .doc("Spatial standard deviation of the bilateral filter.");
pub(crate) const SIGMA_R: Param = Param::float("sigma_r", "Sigma r", 4.25, [0.1, 200.0])
    .slider(0.5, 30.0)
    .group(ADVANCED)
    .doc("Standard deviation of the bilateral filter in range, CIELAB units.");
pub(crate) const LINE_ITERATIONS: Param = Param::int("line_iterations", "Line iterations", 1, [1, 16])
    .slider(1.0, 5.0)
    .structural()
    .group(ADVANCED)
    .doc("Times the line filter runs, each on the lightness times the lines found so far.");
pub(crate) const GUIDE_WEIGHT: Param = Param::float("guide_weight", "Guide weight", 1.0, [0.0, 16.0])
    .slider(0.0, 2.0)
    .structural()
    .group(ADVANCED)
    .doc("Strength of lines where normal, depth or object id break; 0 leaves the guides unread.");
const SIGMA_A: Param = Param::float("sigma_a", "Edge smoothing", 1.5, [0.0, 20.0])
    .slider(0.0, 5.0)
    .pixels()
    .structural()
    .group(ADVANCED)
    .doc("Standard deviation of the final smoothing along the edges, against jagged steps and lines; 0 for none.");

/// The bilateral filter of styles; lengths in pixels of the picture that is rendered.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Abstraction {
    /// Along the local orientation (3.4).
    Oriented(oriented_bilateral::Passes),
    /// Along stream lines (3.5).
    Flow(flow_bilateral::Passes),
    /// Isotropic (3.2), or separable along x and y (3.3).
    Isotropic(bilateral::Passes),
}

impl Abstraction {
    /// The values of `advanced`, as `detail` leaves them.
    pub(crate) fn of(scope: &Scope<'_>) -> Self {
        let [d, r] = look::detail_factors(scope.float("detail"));
        let (sigma_d, sigma_r) = (scope.float("sigma_d") * d, scope.float("sigma_r") * r);
        let chosen = scope.choice("abstraction");
        if chosen == "full" || chosen == "xy" {
            let options = Options { sigma_d, sigma_r, cutoff: bilateral::CUTOFF };
            return Self::Isotropic(bilateral::Passes { separable: chosen == "xy", options });
        }
        if chosen == "flow" {
            let mut passes = flow_bilateral::Passes::default();
            passes.gradient.sigma_d *= sigma_d / 3.0;
            passes.gradient.sigma_r *= sigma_r / 4.25;
            passes.flow.sigma_d *= sigma_d / 3.0;
            passes.flow.sigma_r *= sigma_r / 4.25;
            return Self::Flow(passes);
        }
        let mut passes = oriented_bilateral::Passes::default();
        for options in [&mut passes.gradient, &mut passes.tangent] {
            (options.sigma_d, options.sigma_r) = (sigma_d, sigma_r);
        }
        Self::Oriented(passes)
    }

    /// A Lab image after `iterations`.
    pub(crate) fn apply(
        &self,
        plan: &mut PlanBuilder,
        lab: ImageId,
        tensor: ImageId,
        iterations: i32,
    ) -> ImageId {
        (0..iterations).fold(lab, |lab, _| match self {
            Self::Oriented(passes) => oriented_bilateral::iteration(plan, lab, tensor, passes),
            Self::Flow(passes) => flow_bilateral::iteration(plan, lab, tensor, passes),
            Self::Isotropic(passes) => bilateral::iteration(plan, lab, passes),
        })
    }
}

/// The lines of a style with the parameters of this one.
pub(crate) fn flow(scope: &Scope<'_>, guide_weight: f32) -> FlowDog {
    let lines = Lines::of(scope);
    FlowDog {
        sigma_e: lines.sigma_e,
        k: scope.float("k"),
        sigma_m: lines.sigma_m,
        xdog: lines.xdog(),
        iterations: scope.int("line_iterations"),
        stepping: Stepping::Along(Integrator::TwoStep),
        two_dimensional: false,
        guide_weight,
    }
}

fn build(scope: &mut Scope<'_>) -> ImageId {
    let color = scope.required("color");
    let guide_weight = scope.float("guide_weight");
    let guides = flow_dog::guides(scope, guide_weight);
    let tensor = flow_dog::tensor(scope, color, &guides);
    let abstraction = Abstraction::of(scope);
    let (n_e, n_a) = (scope.int("n_e"), scope.int("n_a"));

    let lab = rgb_to_lab::to_lab(scope.plan, color, 1.0);
    let for_lines = abstraction.apply(scope.plan, lab, tensor, n_e);
    let flow = flow(scope, guide_weight);
    let lightness = lightness::of_lab(scope.plan, for_lines);
    let edges = flow.edges(scope.plan, lightness, tensor, &guides);

    // The first iterations are those behind the lines: the plan records them once.
    let mut flat = abstraction.apply(scope.plan, lab, tensor, n_a);
    let (darks, lights) = (scope.float("darks"), scope.float("lights"));
    if darks != 0.0 || lights != 0.0 {
        flat = tone_curve::tones(scope.plan, flat, darks, lights);
    }
    let levels = scope.int("posterize");
    if levels > 0 {
        let phi_q = look::steepness(scope.float("phi_q"), levels, scope.float("posterize_smooth"));
        let steepness: Steepness = quantization::steepness(scope, phi_q);
        flat = quantize(scope.plan, flat, levels, steepness);
    }
    let (saturation, line) = (scope.float("saturation"), scope.color("line_color"));
    let rgb = lab_to_rgb::to_rgb(scope.plan, flat, saturation);
    let drawn = composite_lines::composite(scope.plan, rgb, edges, line, [0.0; 4]);
    let sigma_a = scope.float("sigma_a");
    if sigma_a > 0.0 {
        return line_integral_convolution::color(
            scope.plan,
            drawn,
            tensor,
            &Lic { sigma: sigma_a, ..Lic::default() },
        );
    }
    drawn
}
