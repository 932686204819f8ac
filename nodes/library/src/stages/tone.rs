//! Tones and saturation of styles.

use crate::declare::spec::{Param, Scope};
use crate::kernels::colour::tone_curve::{self, Params};
use crate::stages::LOOK;
use isophote_engine::ImageId;

pub(crate) const SATURATION: Param = Param::float("saturation", "Saturation", 1.0, [0.0, 4.0])
    .slider(0.0, 2.0)
    .group(LOOK)
    .doc("Factor on the colour axes of CIELAB; 0 is grey.");
pub(crate) const LIGHTS: Param = Param::float("lights", "Lights", 0.0, [-1.0, 1.0])
    .structural()
    .group(LOOK)
    .doc("Raises (above 0) or lowers the light tones.");
pub(crate) const DARKS: Param = Param::float("darks", "Darks", 0.0, [-1.0, 1.0])
    .structural()
    .group(LOOK)
    .doc("Raises (above 0) or lowers the dark tones.");

/// True where `lights` and `darks` leave the tones as they are.
pub(crate) fn is_neutral(scope: &Scope<'_>) -> bool {
    scope.float("darks") == DARKS.default_float() && scope.float("lights") == LIGHTS.default_float()
}

/// The tones of a Lab image as `lights` and `darks` say: no pass where both are neutral.
pub(crate) fn curve(scope: &mut Scope<'_>, lab: ImageId) -> ImageId {
    if is_neutral(scope) {
        return lab;
    }
    let params = Params { darks: scope.float("darks"), lights: scope.float("lights") };
    tone_curve::pass(scope.plan, lab, &params)
}
