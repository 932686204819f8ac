//! Tones and saturation of styles.

use crate::declare::spec::{Param, Scope};
use crate::kernels::colour::tone_curve::{self, Params};
use crate::stages::LOOK;
use isophote_engine::ImageId;

pub(crate) const SATURATION: Param = Param::float("saturation", "Saturation", 1.0, [0.0, 4.0])
    .slider(0.0, 2.0)
    .group(LOOK)
    .hint("Strength of the colours: 0 is grey, 1 leaves them as they are.")
    .doc("Factor on the colour axes of CIELAB.");
pub(crate) const LIGHTS: Param = Param::float("lights", "Highlights", 0.0, [-1.0, 1.0])
    .structural()
    .group(LOOK)
    .hint("Brightens the light tones above 0, and darkens them below.");
pub(crate) const DARKS: Param = Param::float("darks", "Shadows", 0.0, [-1.0, 1.0])
    .structural()
    .group(LOOK)
    .hint("Brightens the dark tones above 0, and darkens them below.");

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
