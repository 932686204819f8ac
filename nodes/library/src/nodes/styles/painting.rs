//! A painting: the multi-scale anisotropic Kuwahara filter (§ 5.5), which abstracts strongly and keeps the
//! direction of features as strokes.

use crate::kernels::colour::{lab_to_rgb, rgb_to_lab, tone_curve};
use crate::look::{self, ADVANCED, LOOK};
use crate::nodes::painting::anisotropic_kuwahara::{ALPHA, LEVELS, P_D, P_S, Painting, RADIUS, TAU_V, TAU_W};
use crate::nodes::painting::generalized_kuwahara::{Q, SECTORS, THRESHOLD};
use crate::ports;
use crate::spec::{NodeSpec, Param, ParamKind, Scope};
use isophote_engine::ImageId;

/// The node.
pub static NODE: NodeSpec = NodeSpec {
    id: "painting",
    label: "Painting",
    group: "styles",
    doc: "Flat strokes of paint that follow the forms of the picture, coarse where little happens and fine \
          where it varies: the anisotropic Kuwahara filter from coarse to fine scales.",
    section: "5.5",
    inputs: &[ports::COLOR, ports::TENSOR],
    output: ports::color_output("The painting."),
    own_params: &[
        BRUSH_SIZE,
        look::DETAIL.doc("How much fine detail survives: scales `p_s` from 1/4 to 4 times."),
        STROKE_LENGTH,
        SHARPNESS,
        look::SATURATION.structural(),
        look::LIGHTS,
        look::DARKS,
        RADIUS.group(ADVANCED),
        PAINTING_LEVELS,
        SECTORS.group(ADVANCED),
        Q.group(ADVANCED),
        THRESHOLD.group(ADVANCED),
        ALPHA.group(ADVANCED),
        P_S.group(ADVANCED),
        P_D.group(ADVANCED),
        TAU_V.group(ADVANCED),
        TAU_W.group(ADVANCED),
    ],
    build,
};

const BRUSH_SIZE: Param = Param::float("brush_size", "Brush size", 12.0, [0.0, 64.0])
    .slider(2.0, 32.0)
    .pixels()
    .group(LOOK)
    .doc("Width of round strokes where the picture varies: scales `radius` by size / 12.");
const STROKE_LENGTH: Param = Param::float("stroke_length", "Stroke length", 0.5, [0.0, 1.0])
    .group(LOOK)
    .doc("How far strokes stretch along the forms: 0 is nearly round; scales `alpha` from 4 to 1/4 times.");
const SHARPNESS: Param = Param::float("sharpness", "Sharpness", 0.5, [0.0, 1.0])
    .group(LOOK)
    .doc("How crisp the borders of strokes are: scales `q` from 1/4 to 4 times.");
/// The levels of the node, more of them by default.
const PAINTING_LEVELS: Param =
    Param { kind: ParamKind::Int { default: 2, range: [1, 8], slider: [1, 6] }, ..LEVELS.group(ADVANCED) };

/// A factor from 1/4 to 4 for a control of 0..=1, 1 at its middle.
fn quadruple(control: f32) -> f32 {
    4f32.powf(2.0 * control - 1.0)
}

fn build(scope: &mut Scope<'_>) -> ImageId {
    let color = scope.required("color");
    let tensor = scope.input("tensor");
    let scale = scope.scale();
    let mut painting = Painting::of(scope, false);
    let brush = scope.float("brush_size") / (12.0 * scale);
    painting.options.radius = (painting.options.radius * brush).min(LARGEST_RADIUS * scale);
    painting.options.alpha =
        (painting.options.alpha / quadruple(scope.float("stroke_length"))).max(LEAST_ALPHA);
    // Neutral controls leave whole exponents whole, which are the fast ones.
    painting.options.q = (painting.options.q * quadruple(scope.float("sharpness"))).clamp(1.0, 64.0);
    painting.p_s *= quadruple(scope.float("detail"));
    let painted = painting.apply(scope.plan, color, tensor, scale);

    let (saturation, darks, lights) =
        (scope.float("saturation"), scope.float("darks"), scope.float("lights"));
    if saturation == 1.0 && darks == 0.0 && lights == 0.0 {
        return painted;
    }
    let lab = rgb_to_lab::to_lab(scope.plan, painted, 1.0);
    let toned = tone_curve::tones(scope.plan, lab, darks, lights);
    lab_to_rgb::to_rgb(scope.plan, toned, saturation)
}

/// Wider strokes cost more than they show; pixels of the full-size picture.
const LARGEST_RADIUS: f32 = 40.0;

/// Longer ellipses reach across the whole picture and gain nothing.
const LEAST_ALPHA: f32 = 0.25;

#[cfg(test)]
mod tests {
    use super::quadruple;

    #[test]
    fn controls_are_neutral_in_the_middle_and_monotone() {
        assert_eq!(quadruple(0.5), 1.0);
        let all: Vec<f32> = (0..=20).map(|i| quadruple(i as f32 / 20.0)).collect();
        assert!(all.windows(2).all(|w| w[0] < w[1]) && all[0] == 0.25 && all[20] == 4.0);
    }
}
