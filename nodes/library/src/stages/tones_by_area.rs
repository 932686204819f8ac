//! Tones of areas instead of bins of lightness: each pixel takes the mode of the colours around it that it belongs to, so
//! that a step lies where areas differ. A slow change, as of skies and of what is out of focus, has no steps, since its
//! window has one mode, and slight shades of a surface join it.

use crate::declare::spec::Scope;
use crate::kernels::colour::local_mode::{self, Options as Modes};
use crate::kernels::colour::nearest_mode::{self, Options as Nearest};
use crate::kernels::structure::colour_restrict;
use isophote_engine::ImageId;

/// Standard deviation of the window, pixels of the full picture.
const AREA: f32 = 20.0;
/// Least standard deviation at a level, pixels of it.
const LEAST_SIGMA: f32 = 2.0;
/// Tolerance of the modes, bins.
const TOLERANCE: f32 = 0.4;
/// Difference to the modes from which on small things stay, in tolerances.
const SMALL: f32 = 1.1;
/// Softness of borders times the steepness of steps.
const SOFTNESS: f32 = 16.0;
/// Least softness, in tolerances.
const CRISPEST: f32 = 0.25;
/// Rounds of mean shift: more change nothing that is seen.
const ROUNDS: i32 = 5;

/// A Lab image in the tones of its areas, which differ by about a bin of `bins` between black and white.
pub(crate) fn flattened(scope: &mut Scope<'_>, lab: ImageId, bins: i32, phi_q: f32) -> ImageId {
    let tolerance = TOLERANCE * 100.0 / bins.max(1) as f32;
    let mut sigma = AREA * scope.scale();
    let plan = &mut *scope.plan;
    // Modes lie a level up at least.
    let mut coarse = colour_restrict::pass(plan, lab);
    sigma *= 0.5;
    while sigma >= 2.0 * LEAST_SIGMA {
        coarse = colour_restrict::pass(plan, coarse);
        sigma *= 0.5;
    }
    let modes = local_mode::pass(plan, coarse, &Modes { sigma, tolerance, rounds: ROUNDS });
    let softness = (SOFTNESS / phi_q.max(1e-6)).max(CRISPEST * tolerance);
    nearest_mode::pass(plan, [lab, modes], &Nearest { softness, least: SMALL * tolerance })
}
