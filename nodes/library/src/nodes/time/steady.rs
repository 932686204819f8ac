//! A picture made steady: its neighbours in time, carried here along motion, are averaged with it.

use crate::declare::ports;
use crate::declare::spec::{NodeSpec, Param, STEADINESS, Scope, WINDOW};
use crate::declare::value::Value;
use crate::stages::steady::{Agreement, COLOUR_AGREEMENT, compared, steadied};
use isophote_engine::ImageId;

/// The node.
pub static NODE: NodeSpec = NodeSpec {
    id: "steady",
    label: "Steady",
    group: "time",
    hint: "Averages flicker and noise of moving pictures away before they reach a style.",
    doc: "Flicker and noise, averaged away before they reach a filter: neighbouring frames are carried here along the \
          motion of things and count where they agree. For pictures that are not stylized; the styles have a steadiness \
          of their own, which averages lines, tones and marks before they lie on paper.",
    section: "",
    inputs: &[ports::COLOR],
    output: ports::color_output("The steady picture."),
    own_params: &[STEADINESS.with_default(Value::Float(0.5)).neutral_at_zero(), WINDOW, COLOR_AGREEMENT],
    build,
};

const COLOR_AGREEMENT: Param =
    Param::float("color_agreement", "Colour agreement", COLOUR_AGREEMENT, [0.1, 200.0])
        .slider(1.0, 40.0)
        .group("time")
        .hint("How different colours of neighbouring frames may be and still be averaged.").doc(
            "How far the colours of frames may differ to be averaged, CIELAB units: the standard deviation of a Gaussian.",
        );

fn build(scope: &mut Scope<'_>) -> ImageId {
    let by = Agreement::rgb(scope.float(COLOR_AGREEMENT.id));
    let [_, color] = steadied(scope, by, |scope| {
        let color = scope.required("color");
        [compared(scope, color), color]
    });
    color
}
