//! Coherence-enhancing filtering as a style (§ 6).

use crate::kernels::colour::quantize_luminance::{Steepness, quantize};
use crate::kernels::colour::{lab_to_rgb, rgb_to_lab, tone_curve};
use crate::look::{self, ADVANCED, LOOK};
use crate::nodes::coherence::coherence_enhancing::{self as filter, Filter};
use crate::nodes::coherence::shock;
use crate::nodes::colour::quantize_luminance as quantization;
use crate::ports;
use crate::spec::{NodeSpec, Param, Scope};
use isophote_engine::ImageId;

/// The node.
pub static NODE: NodeSpec = NodeSpec {
    id: "coherent",
    label: "Coherent",
    group: "styles",
    doc: "The picture as if drawn with one confident hand: hair, branches and folds flow together, outlines \
          become clear, and small round features keep their shape. Smoothing along the local structure and \
          sharpening across it, in turn; defaults are the thesis'.",
    section: "6",
    inputs: &[ports::COLOR],
    output: ports::color_output("The stylized picture."),
    own_params: &[
        filter::ITERATIONS.group(LOOK),
        DETAIL,
        SHARPNESS,
        POSTERIZE,
        look::POSTERIZE_SMOOTH,
        // Left out where it changes nothing: the way to CIELAB and back costs more than a shock.
        look::SATURATION.structural(),
        look::LIGHTS,
        look::DARKS,
        filter::RHO.group(ADVANCED),
        filter::RELAX_THRESHOLD.group(ADVANCED),
        filter::SIGMA_T.group(ADVANCED),
        filter::MAX_ANGLE.group(ADVANCED),
        filter::ADAPT.group(ADVANCED),
        filter::SHOCK.group(ADVANCED),
        shock::SIGMA_G.group(ADVANCED),
        shock::SIGMA_I.group(ADVANCED),
        shock::RADIUS.group(ADVANCED),
        shock::THRESHOLD.group(ADVANCED),
        quantization::PHI_Q.group(ADVANCED),
        filter::SIGMA_A.group(ADVANCED),
    ],
    build,
};

const DETAIL: Param = Param::float("detail", "Detail", 0.5, [0.0, 1.0])
    .group(LOOK)
    .doc("How much survives the abstraction: scales `sigma_t` and `sigma_g` from 2 to 1/2 times.");
const SHARPNESS: Param = Param::float("sharpness", "Sharpness", 0.5, [0.0, 1.0])
    .group(LOOK)
    .doc("How wide a soft edge may be to become a sharp one: scales `radius` from 0 to 2 times.");
const POSTERIZE: Param = Param::int("posterize", "Posterize", 0, [0, 64])
    .slider(0.0, 24.0)
    .structural()
    .group(LOOK)
    .doc("Levels of lightness between black and white; 0 leaves tones continuous.");

fn build(scope: &mut Scope<'_>) -> ImageId {
    let color = scope.required("color");
    let mut filter = Filter::of(scope);
    let [scale, _] = look::detail_factors(scope.float("detail"));
    filter.smoothing.sigma *= scale;
    filter.shock.sigma_g *= scale;
    filter.shock.radius *= 2.0 * scope.float("sharpness");
    let (filtered, tensor) = filter.iterate(scope.plan, color);
    let toned = toned(scope, filtered);
    filter.finish(scope.plan, toned, tensor)
}

/// Tones, levels and saturation, in CIELAB.
fn toned(scope: &mut Scope<'_>, color: ImageId) -> ImageId {
    let (darks, lights) = (scope.float("darks"), scope.float("lights"));
    let (levels, saturation) = (scope.int("posterize"), scope.float("saturation"));
    let curved = darks != 0.0 || lights != 0.0;
    if !curved && levels == 0 && saturation == 1.0 {
        return color;
    }
    let mut lab = rgb_to_lab::to_lab(scope.plan, color, 1.0);
    if curved {
        lab = tone_curve::tones(scope.plan, lab, darks, lights);
    }
    if levels > 0 {
        let phi_q = look::steepness(scope.float("phi_q"), levels, scope.float("posterize_smooth"));
        lab = quantize(scope.plan, lab, levels, Steepness::Fixed(phi_q));
    }
    lab_to_rgb::to_rgb(scope.plan, lab, saturation)
}
