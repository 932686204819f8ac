//! The soft quantization of styles (§ 4.6) under the controls of artists.

use crate::declare::choice::choice;
use crate::declare::spec::{Param, Scope};
use crate::declare::value::Value;
use crate::stages::quantize_luminance::{self, BINS};
use crate::stages::{LOOK, tones_by_area};
use isophote_engine::ImageId;

pub(crate) const POSTERIZE: Param = Param::int("posterize", "Posterize", BINS.default_int(), [0, 64])
    .slider(2.0, 16.0)
    .structural()
    .group(LOOK)
    .hint("Number of tones from black to white; 0 leaves tones smooth.");
pub(crate) const POSTERIZE_SMOOTH: Param = Param::float("posterize_smooth", "Step softness", 0.0, [0.0, 1.0])
    .group(LOOK)
    .hint("How softly one tone goes over into the next.")
    .doc("Relative to the height of the steps: divides `phi_q` by 1 to 20.");

pub(crate) const STEPS: Param = Param::choice("steps", "Steps", Steps::Levels.selected())
    .hint("Where one tone ends: at the same lightness all over, or where areas of the picture differ.")
    .doc(
        "Bins of lightness (4.6), or modes of the colours around each pixel by mean shift (Comaniciu and Meer 2002), \
         which differ from each other by about a bin; their window is about 40 pixels wide.",
    );

choice! {
    /// Places of the steps.
    enum Steps {
        /// At fixed lightness, the same all over the picture.
        Levels ("levels", "By lightness"),
        /// Between areas of colours that differ; skies and soft backgrounds, which change slowly, have none.
        Areas ("areas", "By area"),
    }
}

/// The option by area, as a default.
pub(crate) const BY_AREA: Value = Value::Choice(Steps::Areas.selected().index);

/// A Lab image in `bins` tones of a steepness, between which steps lie where `steps` says.
pub(crate) fn flattened(scope: &mut Scope<'_>, lab: ImageId, bins: i32, phi_q: f32) -> ImageId {
    if is_by_area(scope) {
        return tones_by_area::flattened(scope, lab, bins, phi_q);
    }
    quantize_luminance::flattened(scope, lab, bins, phi_q)
}

/// True where steps lie between areas.
pub(crate) fn is_by_area(scope: &Scope<'_>) -> bool {
    scope.option::<Steps>("steps") == Steps::Areas
}

/// Steepness of the steps between `levels` as the parameters of a style say.
pub(crate) fn steepness(scope: &Scope<'_>, levels: i32) -> f32 {
    softened(scope.float("phi_q"), levels, scope.float("posterize_smooth"))
}

/// Steepness of steps between `levels` for a technical value `phi_q` and a softness 0..=1; steps keep
/// their shape relative to their height, which is that of the default levels by default.
fn softened(phi_q: f32, levels: i32, softness: f32) -> f32 {
    let height = levels as f32 / POSTERIZE.default_int() as f32;
    phi_q * height / (1.0 + 19.0 * softness)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The `phi_q` of styles.
    const CRISP: f32 = 8.0;
    const LEVELS: i32 = POSTERIZE.default_int();

    #[test]
    fn neutral_controls_change_nothing_and_softness_softens() {
        assert_eq!(softened(CRISP, LEVELS, POSTERIZE_SMOOTH.default_float()), CRISP);
        for i in 0..100 {
            let [a, b] = [i, i + 1].map(|i| softened(CRISP, LEVELS, i as f32 / 100.0));
            assert!(a > b);
        }
    }

    #[test]
    fn steps_of_any_number_of_levels_end_where_their_bins_do() {
        for levels in [2, 8, 64] {
            let half_bin = 50.0 / levels as f32;
            assert!((softened(CRISP, levels, 1.0) * half_bin).tanh() > 0.98);
        }
    }
}
