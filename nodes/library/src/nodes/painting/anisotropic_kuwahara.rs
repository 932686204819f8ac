//! The anisotropic Kuwahara filter (§ 5.4), at one scale or at several (§ 5.5).

use crate::declare::ports;
use crate::declare::spec::{NodeSpec, Param, Port, STEADINESS, Scope, WINDOW};
use crate::stages::anisotropic_kuwahara::{
    ALPHA, LEVELS, LIMIT_RANGE, P_D, P_S, Painting, RADIUS, TAU_V, TAU_W, Weights,
};
use crate::stages::generalized_kuwahara::{Q, SECTORS, THRESHOLD};
use crate::stages::steady::steadied_picture;
use isophote_engine::ImageId;

/// The node.
pub static NODE: NodeSpec = NodeSpec {
    id: "anisotropic_kuwahara",
    label: "Flowing Kuwahara",
    group: "painting",
    hint: "Paints the picture in flat strokes that lie along its forms, with sharp borders.",
    doc: "A painterly flattening along the local structure: every pixel takes the mean of the sectors of an \
          ellipse that lies along it, those that vary least counting most (5.14, 5.33). Directional features \
          survive and become strokes, borders stay sharp, and no clusters form. Several levels abstract more \
          than a larger radius could. Transparent pixels lend no colour, and coverage stays as it is.",
    section: "5.4, 5.5",
    inputs: &[ports::COLOR, TENSOR],
    output: ports::color_output("The painted picture."),
    own_params: &[
        RADIUS.neutral_at_zero(),
        SECTORS,
        Q,
        THRESHOLD,
        ALPHA,
        Param::choice("weights", "Precision", Weights::Polynomial.selected()).hint("How patches are weighted: exactly, or nearly so and faster; the eye hardly sees a difference.").doc(
            "Weighting functions of the sectors: sampled from their definition (5.33), or polynomials (5.38), \
             which hardly differ and are faster on CPUs.",
        ),
        Param::int("iterations", "Rounds", 1, [1, 10])
            .slider(1.0, 5.0)
            .structural()
            .hint("How often the picture is painted over.").doc("Times that the filter runs, each time on its own result and that one's orientation."),
        LEVELS,
        P_S,
        P_D,
        TAU_V,
        TAU_W,
        LIMIT_RANGE,
        STEADINESS,
        WINDOW,
    ],
    build,
};

const TENSOR: Port = Port {
    doc: "The orientation to follow, in all iterations and at the finest level; the smoothed structure tensor \
          of the picture when open.",
    ..ports::TENSOR
};

fn build(scope: &mut Scope<'_>) -> ImageId {
    let color = steadied_picture(scope);
    let tensor = scope.input("tensor");
    let weights = scope.option("weights");
    let painting = Painting::of(scope, weights);
    let (iterations, scale) = (scope.int("iterations"), scope.scale());
    (0..iterations).fold(color, |color, _| painting.apply(scope.plan, color, tensor, scale))
}
