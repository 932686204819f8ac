//! A painting: the multi-scale anisotropic Kuwahara filter (§ 5.5), which abstracts strongly and keeps the
//! direction of features as strokes.

use crate::declare::ports;
use crate::declare::spec::{NodeSpec, Param, Port, STEADINESS, Scope, WINDOW};
use crate::declare::value::Value;
use crate::kernels::colour::{lab_to_rgb, rgb_to_lab};
use crate::stages::anisotropic_kuwahara::{
    ALPHA, LEVELS, LIMIT_RANGE, P_D, P_S, Painting, RADIUS, TAU_V, TAU_W, Weights,
};
use crate::stages::control::Control;
use crate::stages::generalized_kuwahara::{Q, SECTORS, THRESHOLD};
use crate::stages::steady::steadied_picture;
use crate::stages::{ADVANCED, LOOK, abstraction, flow_dog, tone};
use isophote_engine::ImageId;

/// The node.
pub static NODE: NodeSpec = NodeSpec {
    id: "painting",
    label: "Painting",
    group: "styles",
    hint: "Flat strokes of paint that follow the forms: coarse where little happens, fine where the picture varies.",
    doc: "Flat strokes of paint that follow the forms of the picture, coarse where little happens and fine \
          where it varies: the anisotropic Kuwahara filter from coarse to fine scales. No stroke is painted \
          across strong contrast, nor across edges of normals, depth and object ids, where given.",
    section: "5.5",
    inputs: &[ports::COLOR, ports::TENSOR, NORMAL, DEPTH, OBJECT_ID],
    output: ports::color_output("The painting."),
    own_params: &[
        BRUSH_SIZE,
        abstraction::DETAIL
            .doc("Scales `p_s` from 1/4 times on and, above the middle, the brush down to 0.6."),
        STROKE_LENGTH,
        SHARPNESS,
        tone::SATURATION.structural(),
        tone::LIGHTS,
        tone::DARKS,
        RADIUS.group(ADVANCED),
        // More of them than the node has by default.
        LEVELS.with_default(Value::Int(4)).group(ADVANCED),
        SECTORS.group(ADVANCED),
        Q.group(ADVANCED),
        // Below the thesis', under which soft light on skin is one blur instead of patches of paint.
        THRESHOLD.with_default(Value::Float(0.006)).group(ADVANCED),
        ALPHA.group(ADVANCED),
        P_S.with_default(Value::Float(0.85)).group(ADVANCED),
        P_D.group(ADVANCED),
        TAU_V.with_default(Value::Float(0.01)).group(ADVANCED),
        TAU_W.group(ADVANCED),
        LIMIT_RANGE.with_default(Value::Bool(true)).group(ADVANCED),
        STEADINESS,
        WINDOW,
    ],
    build,
};

const NORMAL: Port = Port { doc: "View-space normals; strokes end at creases.", ..flow_dog::NORMAL };
const DEPTH: Port = Port { doc: "Distance from the camera; strokes end where it jumps.", ..flow_dog::DEPTH };
const OBJECT_ID: Port = Port { doc: "Object numbers; strokes end at borders.", ..flow_dog::OBJECT_ID };
const BRUSH_SIZE: Param = Param::length("brush_size", "Brush size", 12.0, [0.0, 64.0])
    .slider(2.0, 32.0)
    .group(LOOK)
    .hint("Width of the strokes where the picture varies.")
    .doc("Width of round strokes: scales `radius` by size / 12.");
const STROKE_LENGTH: Param = Param::float("stroke_length", "Stroke length", 0.5, [0.0, 1.0])
    .group(LOOK)
    .hint("How far strokes stretch along the forms: 0 is nearly round.")
    .doc("Scales `alpha` from 4 to 1/4 times.");
const SHARPNESS: Param = Param::float("sharpness", "Sharpness", 0.5, [0.0, 1.0])
    .group(LOOK)
    .hint("How crisp the borders of strokes are.")
    .doc("Scales `q` from 1/4 to 4 times.");
/// A factor from 1/4 to 4 for a control of 0..=1, 1 at its middle.
fn quadruple(control: f32) -> f32 {
    4f32.powf(2.0 * control - 1.0)
}

fn build(scope: &mut Scope<'_>) -> ImageId {
    let color = steadied_picture(scope);
    let tensor = scope.input("tensor");
    let scale = scope.scale();
    let mut painting = Painting::of(scope, Weights::Polynomial);
    let brush = scope.float("brush_size") / (BRUSH_SIZE.default_float() * scale);
    // The limits of the parameters: wider strokes cost more than they show, longer ones gain nothing.
    painting.options.radius = (painting.options.radius * brush).min(RADIUS.range[1] * scale);
    painting.options.alpha =
        (painting.options.alpha / quadruple(scope.float("stroke_length"))).max(ALPHA.range[0]);
    // Neutral controls leave whole exponents whole, which are the fast ones.
    painting.options.q =
        (painting.options.q * quadruple(scope.float("sharpness"))).clamp(Q.range[0], Q.range[1]);
    let detail = scope.float("detail");
    painting.p_s *= quadruple(detail.min(0.5));
    // Beyond the default nearly all that varies is kept already: finer strokes show more.
    painting.options.radius *= 1.0 - 0.4 * (2.0 * detail - 1.0).max(0.0);
    // Whatever lines weigh: the guides are all there is to say where things end.
    painting.guarded = Some(flow_dog::guides(scope, 1.0));
    let painted = painting.apply(scope.plan, color, tensor, scale);
    let painted = Control::of(scope).kept(scope.plan, [color, painted]);

    let saturation = scope.float("saturation");
    if saturation == tone::SATURATION.default_float() && tone::is_neutral(scope) {
        return painted;
    }
    let lab = rgb_to_lab::pass(scope.plan, painted, 1.0);
    let toned = tone::curve(scope, lab);
    lab_to_rgb::pass(scope.plan, toned, saturation)
}

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
