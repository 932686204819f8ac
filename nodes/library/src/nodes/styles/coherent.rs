//! Coherence-enhancing filtering as a style (§ 6).

use crate::declare::ports;
use crate::declare::spec::{NodeSpec, Param, STEADINESS, Scope, WINDOW};
use crate::declare::value::Value;
use crate::kernels::colour::quantize_luminance::{self, Steepness};
use crate::kernels::colour::{lab_to_rgb, rgb_to_lab};
use crate::stages::coherence_enhancing::{self as filter, Filter, Stepping, filtered};
use crate::stages::control::Control;
use crate::stages::{
    ADVANCED, LOOK, abstraction, quantization as levels, quantize_luminance as quantization, shock, tone,
    tones_by_area,
};
use isophote_engine::ImageId;

/// The node.
pub static NODE: NodeSpec = NodeSpec {
    id: "coherent",
    label: "Coherent",
    group: "styles",
    hint: "The picture as if drawn with one confident hand: hair, branches and folds flow together, and outlines become clear.",
    doc: "The picture as if drawn with one confident hand: hair, branches and folds flow together, outlines \
          become clear, and small round features keep their shape. Smoothing along the local structure and \
          sharpening across it, in turn; lengths are up to two and a half times the thesis', so that strokes are seen when the \
          picture is fitted to a screen. `coherence_enhancing` has the thesis' own.",
    section: "6",
    inputs: &[ports::COLOR, ports::TENSOR],
    output: ports::color_output("The stylized picture."),
    own_params: &[
        filter::ITERATIONS.group(LOOK),
        DETAIL,
        SHARPNESS,
        levels::POSTERIZE.with_default(Value::Int(0)).slider(0.0, 16.0),
        levels::POSTERIZE_SMOOTH,
        levels::STEPS.group(LOOK),
        // Left out where it changes nothing: the way to CIELAB and back costs more than a shock.
        tone::SATURATION.structural(),
        tone::LIGHTS,
        tone::DARKS,
        filter::STEPPING.with_default(Value::Choice(Stepping::Stretched.selected().index)).group(ADVANCED),
        filter::RHO.with_default(Value::Float(2.5)).group(ADVANCED),
        filter::RELAX_THRESHOLD.group(ADVANCED),
        filter::SIGMA_T.with_default(Value::Float(10.0)).slider(0.0, 30.0).group(ADVANCED),
        filter::MAX_ANGLE.group(ADVANCED),
        filter::ADAPT.group(ADVANCED),
        filter::SHOCK.group(ADVANCED),
        shock::SIGMA_G.with_default(Value::Float(2.0)).group(ADVANCED),
        shock::SIGMA_I.group(ADVANCED),
        shock::RADIUS.with_default(Value::Float(3.0)).slider(0.0, 12.0).group(ADVANCED),
        shock::THRESHOLD.group(ADVANCED),
        quantization::PHI_Q.group(ADVANCED),
        filter::SIGMA_A.with_default(Value::Float(3.0)).group(ADVANCED),
        STEADINESS,
        WINDOW,
    ],
    build,
};

const DETAIL: Param = abstraction::DETAIL.doc("Scales `sigma_t` and `sigma_g` from 2 to 1/2 times.");
const SHARPNESS: Param = Param::float("sharpness", "Sharpness", 0.5, [0.0, 1.0])
    .group(LOOK)
    .hint("How wide a soft edge may be to become a sharp one.")
    .doc("Scales `radius` from 0 to 2 times.");

fn build(scope: &mut Scope<'_>) -> ImageId {
    let (filtered, tensor) = filtered(scope, of);
    let toned = toned(scope, filtered);
    let finished = of(scope).finish(scope.plan, toned, tensor);
    let color = scope.required("color");
    Control::of(scope).kept(scope.plan, [color, finished])
}

/// The filter under the controls of artists.
fn of(scope: &mut Scope<'_>) -> Filter {
    let mut filter = Filter::of(scope);
    let [scale, _] = abstraction::detail_factors(scope.float("detail"));
    filter.smoothing.sigma *= scale;
    filter.directed.sigma_g *= scale;
    filter.directed.radius *= scope.float("sharpness") / SHARPNESS.default_float();
    filter
}

/// Tones, levels and saturation, in CIELAB.
fn toned(scope: &mut Scope<'_>, color: ImageId) -> ImageId {
    let (bins, saturation) = (scope.int("posterize"), scope.float("saturation"));
    if tone::is_neutral(scope) && bins == 0 && saturation == tone::SATURATION.default_float() {
        return color;
    }
    let mut lab = rgb_to_lab::pass(scope.plan, color, 1.0);
    lab = tone::curve(scope, lab);
    if bins > 0 {
        let phi_q = levels::steepness(scope, bins);
        lab = if levels::is_by_area(scope) {
            tones_by_area::flattened(scope, lab, bins, phi_q)
        } else {
            quantize_luminance::pass(scope.plan, lab, bins, Steepness::Fixed(phi_q))
        };
    }
    lab_to_rgb::pass(scope.plan, lab, saturation)
}
