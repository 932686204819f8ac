//! The `look` controls of styles: what an artist turns, and how it maps onto the technical parameters.
//!
//! The technical parameters, in the group `advanced`, hold the thesis' values under the thesis' names.
//! Each look control scales or shifts one or two of them and is neutral at its default, so that
//! defaults give exactly the thesis' values and whoever sets a technical value gets that value. Every
//! mapping is monotone.

use crate::kernels::shared::edge_threshold::{Threshold, Xdog};
use crate::spec::{Param, Scope};

/// Heading of the controls for artists.
pub(crate) const LOOK: &str = "look";
/// Heading of the technical parameters.
pub(crate) const ADVANCED: &str = "advanced";

pub(crate) const LINE_WIDTH: Param = Param::float("line_width", "Line width", 2.0, [0.2, 40.0])
    .slider(0.8, 10.0)
    .pixels()
    .group(LOOK)
    .doc("Width of lines: scales `sigma_e` by width / 2 and, above 2, `sigma_m` by its root, so that wide lines do not break.");
pub(crate) const LINE_AMOUNT: Param = Param::float("line_amount", "Line amount", 0.5, [0.0, 1.0])
    .group(LOOK)
    .doc("How many lines: 0 draws none, 1 draws them at faint edges too; scales 1 - `tau`.");
pub(crate) const SUPPRESS_SMALL: Param =
    Param::float("suppress_small", "Suppress small", 0.0, [0.0, 1.0]).group(LOOK).doc(
        "Drops short and weak lines: lengthens `sigma_m` up to three times and lowers `epsilon` by up to 0.75.",
    );
pub(crate) const DETAIL: Param = Param::float("detail", "Detail", 0.5, [0.0, 1.0]).group(LOOK).doc(
    "How much survives the abstraction: scales `sigma_r` from 4 to 1/4 times and `sigma_d` from 2 to 1/2.",
);
pub(crate) const POSTERIZE: Param = Param::int("posterize", "Posterize", 8, [0, 64])
    .slider(0.0, 24.0)
    .structural()
    .group(LOOK)
    .doc("Levels of lightness between black and white; 0 leaves tones continuous.");
pub(crate) const POSTERIZE_SMOOTH: Param =
    Param::float("posterize_smooth", "Posterize smooth", 0.25, [0.0, 1.0])
        .group(LOOK)
        .doc("Softness of the steps between levels, relative to their height: scales `phi_q` from 2 to 1/8.");
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

/// The technical parameters of lines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lines {
    pub sigma_e: f32,
    pub sigma_m: f32,
    pub tau: f32,
    pub epsilon: f32,
    pub phi: f32,
}

impl Lines {
    /// The values of `advanced`, as the look controls leave them.
    pub fn of(scope: &Scope<'_>) -> Self {
        Self {
            sigma_e: scope.float("sigma_e"),
            sigma_m: scope.float("sigma_m"),
            tau: scope.float("tau"),
            epsilon: scope.float("epsilon"),
            phi: scope.float("phi"),
        }
        .looking(
            // A ratio of two widths has no unit: the scale of the rendering is taken out again.
            scope.float("line_width") / scope.scale(),
            scope.float("line_amount"),
            scope.float("suppress_small"),
        )
    }

    /// `width` in pixels of the full picture, 2 is neutral; `amount` 0..=1, 0.5 is neutral;
    /// `suppress` 0..=1, 0 is neutral.
    fn looking(self, width: f32, amount: f32, suppress: f32) -> Self {
        let base = ((1.0 - self.tau) * base_factor(amount)).clamp(0.0, 1.0);
        Self {
            sigma_e: self.sigma_e * (width / 2.0),
            sigma_m: self.sigma_m * longer(width) * (1.0 + 2.0 * suppress),
            tau: 1.0 - base,
            epsilon: self.epsilon - 0.75 * suppress,
            phi: self.phi,
        }
    }

    /// Weights and threshold (4.7, 4.8).
    pub fn xdog(&self) -> Xdog {
        Xdog::tau(self.tau, self.epsilon, self.phi, Threshold::Tanh)
    }
}

/// Factor on the smoothing along lines `width` wide, 2 and below is neutral: wide ones fall into blots when
/// what joins them stays short.
pub(crate) fn longer(width: f32) -> f32 {
    (width / 2.0).max(1.0).sqrt()
}

/// Factor on 1 - tau: infinite at 0, where no line is left; 1 at 0.5; 1/4 at 1, since nothing at all
/// would let the noise of flat parts through.
fn base_factor(amount: f32) -> f32 {
    if amount <= 0.0 {
        f32::INFINITY
    } else if amount <= 0.5 {
        (1.0 - amount) / amount
    } else {
        4f32.powf(1.0 - 2.0 * amount)
    }
}

/// Factors on (`sigma_d`, `sigma_r`) for `detail` 0..=1.
pub(crate) fn detail_factors(detail: f32) -> [f32; 2] {
    [2f32.powf(1.0 - 2.0 * detail), 4f32.powf(1.0 - 2.0 * detail)]
}

/// Steepness of steps between `levels` for a technical value `phi_q` and a softness 0..=1; steps keep
/// their shape relative to their height, which is that of 8 levels by default.
pub(crate) fn steepness(phi_q: f32, levels: i32, softness: f32) -> f32 {
    phi_q * (levels as f32 / 8.0) * 16f32.powf(0.25 - softness)
}

#[cfg(test)]
mod tests {
    use super::*;

    const THESIS: Lines = Lines { sigma_e: 1.0, sigma_m: 3.0, tau: 0.99, epsilon: 0.0, phi: 2.0 };

    #[test]
    fn neutral_controls_change_nothing() {
        assert_eq!(THESIS.looking(2.0, 0.5, 0.0), THESIS);
        assert_eq!(detail_factors(0.5), [1.0, 1.0]);
        assert_eq!(steepness(3.4, 8, 0.25), 3.4);
    }

    #[test]
    fn mappings_are_monotone_and_stay_in_range() {
        let all: Vec<f32> = (0..=100).map(|i| i as f32 / 100.0).collect();
        for pair in all.windows(2) {
            let (a, b) = (THESIS.looking(2.0, pair[0], 0.0), THESIS.looking(2.0, pair[1], 0.0));
            assert!(a.tau <= b.tau && (0.0..=1.0).contains(&a.tau), "{pair:?}: {} {}", a.tau, b.tau);
            let (a, b) = (THESIS.looking(2.0, 0.5, pair[0]), THESIS.looking(2.0, 0.5, pair[1]));
            assert!(a.sigma_m < b.sigma_m && a.epsilon > b.epsilon);
            let (a, b) = (THESIS.looking(40.0 * pair[0], 0.5, 0.0), THESIS.looking(40.0 * pair[1], 0.5, 0.0));
            assert!(a.sigma_e < b.sigma_e && a.sigma_m <= b.sigma_m);
            assert!(detail_factors(pair[0])[0] > detail_factors(pair[1])[0]);
            assert!(steepness(3.4, 8, pair[0]) > steepness(3.4, 8, pair[1]));
        }
        assert_eq!(THESIS.looking(2.0, 0.0, 0.0).tau, 0.0);
        assert!(THESIS.looking(2.0, 1.0, 0.0).tau < 1.0);
        // Steps of any number of levels end where their bins do.
        for levels in [2, 8, 64] {
            let half_bin = 50.0 / levels as f32;
            assert!((steepness(3.4, levels, 1.0) * half_bin).tanh() > 0.98);
        }
    }
}
