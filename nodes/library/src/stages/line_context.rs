//! Responses of lines weighed by what is around them: against the local deviation of lightness, and by how many lines are
//! near (Grigorescu, Petkov and Westenberg 2003). Both are found at a coarser level of the pyramid, where windows are small.

use crate::declare::spec::{Param, Scope};
use crate::kernels::lines::{lightness_moments, line_energy, local_contrast, surround_inhibition};
use crate::kernels::smoothing::gaussian_blur;
use crate::kernels::structure::{tensor_interpolate, tensor_restrict};
use isophote_engine::{Class, ImageId, PlanBuilder};

pub(crate) const LOCAL_CONTRAST: Param = Param::float("local_contrast", "Local contrast", 0.0, [0.0, 1.0])
    .structural()
    .hint("Judges edges against what is around them, so that soft light has lines and hard light is not black.")
    .doc(
        "Share by which the response is divided by the local deviation of lightness, in a window of about 16 pixels \
         with a floor (Heeger 1992); 0 leaves it as the thesis has it.",
    );
pub(crate) const INHIBITION: Param = Param::float("inhibition", "Calm textures", 0.0, [0.0, 1.0])
    .structural()
    .hint("Leaves out lines where there are many, as in grass, hair and cloth; single ones stay.")
    .doc(
        "Strength of surround inhibition (Grigorescu, Petkov, Westenberg 2003): the threshold rises with \
         the lines in a neighbourhood of about 60 pixels around, those along the own orientation counting less, and not where \
         lines stand alone.",
    );

pub(crate) const COLOUR_EDGES: Param = Param::float("colour_edges", "Colour edges", 0.0, [0.0, 1.0])
    .structural()
    .hint("Draws lines between colours that are equally light, such as red on blue.")
    .doc("Weight of a and b against L in the difference across an edge, which is found in CIELAB; 0 is lightness alone.");

/// Standard deviation of the window of the local deviation, pixels of the full picture: 16 pixels wide.
const WINDOW: f32 = 8.0;
/// Share of the deviation that counts.
const SHARE: f32 = 0.35;
/// Least divisor, units of L: what is weaker is noise.
const FLOOR: f32 = 2.5;
/// Divisor at which responses stay as they are.
const NEUTRAL: f32 = 10.0;
/// Lightness below which no weaker edges draw lines, units of L: contrast that is raised would make lines of noise.
const LEAST: f32 = 40.0;
/// Standard deviations of the surround and of what is close by, pixels of the full picture.
const SURROUND: f32 = 44.0;
const NEAR: f32 = 10.0;
/// Difference of Gaussians that counts at most in the energy of lines, units of L.
const MOST: f32 = 40.0;
/// Weight of lines of the own orientation in it.
const OWN: f32 = 0.78;
/// Energy around that a unit of it close by excuses: in a texture there is as much around as close by, around a lone line
/// a quarter.
const EXCUSED: f32 = 0.6;
/// Difference of Gaussians that is taken off per unit of energy: lines in a texture yield but for the strongest.
const INHIBITED: f32 = 24.0;

/// How far surroundings count.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct LineContext {
    /// Share of the local deviation, 0..=1.
    contrast: f32,
    /// Strength of the inhibition, 0 for none.
    inhibition: f32,
    /// Lightness that counts at least, units of L: darker grounds are no lines by themselves.
    least: f32,
    /// Pixels that are rendered for one of the full picture.
    scale: f32,
}

/// What lines are found in: the lightness (L alpha, alpha) and the orientation of the lines.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ground {
    pub lightness: ImageId,
    pub field: ImageId,
    /// Weight of the lightness in the response.
    pub base: f32,
    /// Weight of the difference of Gaussians in it.
    pub edge: f32,
}

impl LineContext {
    /// The values of the parameters above; `texture` is the share of lines that the picture's own edges keep, 0..=1.
    pub(crate) fn of(scope: &Scope<'_>, texture: f32) -> Self {
        Self {
            contrast: scope.float(LOCAL_CONTRAST.id),
            inhibition: scope.float(INHIBITION.id) * (3.0 - 2.0 * texture),
            least: 0.0,
            scale: scope.scale(),
        }
    }

    /// Lines alone, without the masses that lightness below `least` draws.
    pub(crate) fn without_masses(self, least: f32) -> Self {
        Self { least, ..self }
    }

    /// True where nothing around a line counts.
    pub(crate) fn is_off(&self) -> bool {
        self.contrast <= 0.0 && self.inhibition <= 0.0 && self.least <= 0.0
    }

    /// The response (u alpha, alpha) of a difference of Gaussians alone, and of the lightness beneath it, in its context.
    pub(crate) fn weighed(&self, plan: &mut PlanBuilder, difference: ImageId, ground: &Ground) -> ImageId {
        // In the sharpening form lightness is tone.
        let least = if ground.base < 0.5 { LEAST * self.contrast } else { self.least };
        let Ground { lightness, field, base, edge } = *ground;
        let params = local_contrast::Params {
            base,
            least,
            amount: self.contrast,
            strength: NEUTRAL,
            share: SHARE * SHARE,
            floor: FLOOR * FLOOR,
        };
        let moments = if self.contrast > 0.0 {
            let moments = lightness_moments::pass(plan, lightness);
            surroundings(plan, moments, WINDOW * self.scale)
        } else {
            lightness_moments::pass(plan, lightness)
        };
        let response = local_contrast::pass(plan, [difference, lightness, moments], &params);
        if self.inhibition <= 0.0 {
            return response;
        }
        let energy = line_energy::Params { base, least, most: MOST * edge };
        let energy = line_energy::pass(plan, [response, lightness, field], &energy);
        let [surround, near] = [SURROUND, NEAR].map(|sigma| surroundings(plan, energy, sigma * self.scale));
        let params = surround_inhibition::Params {
            base,
            least,
            inhibition: self.inhibition * INHIBITED,
            own: OWN,
            excused: EXCUSED,
        };
        surround_inhibition::pass(plan, [response, lightness, field, surround, near], &params)
    }
}

/// An image of sums averaged by a Gaussian of standard deviation `sigma`, at the coarsest level that shows it.
pub(crate) fn surroundings(plan: &mut PlanBuilder, image: ImageId, sigma: f32) -> ImageId {
    /// Least standard deviation at a level, pixels of it.
    const LEAST_SIGMA: f32 = 2.0;
    const MOST_LEVELS: usize = 8;
    // Plans are described without allocating.
    let mut levels = [image; MOST_LEVELS];
    let (mut count, mut left) = (1, sigma);
    while left >= 2.0 * LEAST_SIGMA && count < MOST_LEVELS {
        levels[count] = tensor_restrict::pass_mean(plan, levels[count - 1]);
        count += 1;
        left *= 0.5;
    }
    let mean = gaussian_blur::pass(plan, levels[count - 1], left, Class::Field);
    let finer = levels[..count - 1].iter().rev();
    finer.fold(mean, |coarse, fine| tensor_interpolate::pass_to(plan, *fine, coarse))
}
