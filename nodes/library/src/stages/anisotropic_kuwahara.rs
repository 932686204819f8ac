//! The anisotropic Kuwahara filter at several scales (§ 5.4, 5.5).

use crate::declare::choice::choice;
use crate::declare::spec::{Param, Scope};
use crate::kernels::painting::anisotropic_kuwahara::{self as polynomial, Options};
use crate::kernels::painting::propagate_colour::{self, Options as Propagation};
use crate::kernels::painting::{anisotropic_kuwahara_texture as texture, lanczos_half, propagate_tensor};
use crate::stages::flow_map::Flow;
use crate::stages::generalized_kuwahara::sectors;
use crate::stages::structure_tensor::{self, of_color_and_guides};
use crate::stages::tensor_options::{Guides, TensorOptions};
use isophote_engine::{ImageId, PlanBuilder};

pub(crate) const RADIUS: Param = Param::length("radius", "Radius", 6.0, [0.0, 40.0]).slider(1.0, 16.0).hint("Size of the patches that colours are averaged over: larger ones paint more coarsely.").doc(
    "Radius of the disc that is stretched to an ellipse (r); at every level the same number of its pixels.",
);
pub(crate) const ALPHA: Param = Param::float("alpha", "Roundness", 1.0, [0.25, 100.0]).slider(0.25, 4.0).hint("How round the patches stay: low values stretch them far along the forms.").doc(
    "Tunes the ellipse (alpha of 5.22): up to ((1 + alpha) / alpha)^2 times as long as wide, 4 by default.",
);
pub(crate) const LEVELS: Param = Param::int("levels", "Scales", 1, [1, MAX_LEVELS as i32])
    .slider(1.0, 6.0)
    .structural()
    .hint("Sizes at which the picture is painted: more give large strokes where little happens.")
    .doc("Scales, each half as large as the one before (5.5); 1 for the filter at a single scale.");
pub(crate) const P_S: Param = Param::float("p_s", "Fine detail", 0.5, [0.0, 10.0])
    .slider(0.0, 2.0)
    .hint("How much of the finer scales shows where the picture varies. Counts with several scales.")
    .doc("With several levels: how much of each scale's own picture stays where it varies (p_s of 5.5.2).");
pub(crate) const P_D: Param = Param::float("p_d", "Coarse detail", 1.25, [0.1, 10.0])
    .slider(0.5, 2.0)
    .hint("How much more detail the coarser scales keep than the finer ones. Counts with several scales.")
    .doc("With several levels: factor on `p_s` from each scale to the coarser one (p_d of 5.5.2).");
pub(crate) const TAU_V: Param = Param::float("tau_v", "Noise threshold", 0.1, [0.0, 1.0])
    .slider(0.0, 0.5)
    .hint("Differences below this are taken for noise and painted over. Counts with several scales.")
    .doc("With several levels: how little variation is taken for none (tau_v of 5.5.2).");
pub(crate) const TAU_W: Param = Param::float("tau_w", "Least contrast", 0.02, [0.001, 1.0])
    .slider(0.001, 0.1)
    .hint("Contrast that even flat patches are taken to have. Counts with several scales.").doc("With several levels: least standard deviation of a sector in the measure of variation (tau_w of 5.5.2).");
pub(crate) const LIMIT_RANGE: Param = Param::bool("limit_range", "No dark rings", false).hint("Keeps dark rings away from highlights. Counts with several scales.").doc("Keeps each coarser scale within the range of the pixels below it, where Lanczos resampling as published (5.5.1) draws dark rings around highlights.");

choice! {
    /// The weighting functions of the sectors.
    pub(crate) enum Weights {
        /// Sampled from their definition.
        Texture ("texture", "Exact"),
        /// Polynomials, which are faster.
        Polynomial ("polynomial", "Fast"),
    }
}

/// The filter at several scales.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Painting {
    /// At each scale.
    pub options: Options,
    /// The weighting functions of the sectors.
    pub weights: Weights,
    /// Scales, at least 1.
    pub levels: i32,
    /// Detail kept at all scales.
    pub p_s: f32,
    /// Factor on it per scale.
    pub p_d: f32,
    /// Variance that counts as no variation.
    pub tau_v: f32,
    /// Flow that bends the orientation at the finest level.
    pub flow: Option<Flow>,
    /// True where coarser scales stay in the range of finer ones.
    pub limited: bool,
    /// Guides whose edges, with those of strong contrast, coarser scales are not painted across; none: they are.
    pub guarded: Option<Guides>,
}

impl Painting {
    /// The values of the parameters of these names, which nodes that paint share.
    pub(crate) fn of(scope: &mut Scope<'_>, weights: Weights) -> Self {
        Self {
            flow: Flow::of(scope),
            options: Options {
                radius: scope.float("radius"),
                sectors: sectors(scope),
                q: scope.float("q"),
                threshold: scope.float("threshold"),
                alpha: scope.float("alpha"),
                deviation_floor: scope.float("tau_w"),
            },
            weights,
            levels: scope.int("levels"),
            p_s: scope.float("p_s"),
            p_d: scope.float("p_d"),
            tau_v: scope.float("tau_v"),
            limited: scope.bool("limit_range"),
            guarded: None,
        }
    }

    /// Filters a colour (Fig. 5.25). `tensor` is the orientation at the finest level, where one is given;
    /// `scale` is that of the picture.
    pub(crate) fn apply(
        &self,
        plan: &mut PlanBuilder,
        color: ImageId,
        tensor: Option<ImageId>,
        scale: f32,
    ) -> ImageId {
        let options = TensorOptions::at_scale(scale);
        let mut levels = [color; MAX_LEVELS];
        let mut count = 1;
        while count < MAX_LEVELS.min(self.levels.max(1) as usize) {
            let finer = levels[count - 1];
            let level = plan.desc(finer).level;
            // A picture of a few pixels has no coarser structure.
            if plan.level_size(level).iter().all(|n| *n <= SMALLEST) {
                break;
            }
            levels[count] = lanczos_half::pass(plan, finer, self.limited);
            count += 1;
        }
        let mut below: Option<[ImageId; 3]> = None;
        for (k, image) in levels[..count].iter().enumerate().rev() {
            let mut merged = *image;
            if let Some([colour, deviations, _]) = below {
                let gain = self.p_s * self.p_d.powi(k as i32);
                let guarded = self.guarded.filter(|_| k == 0);
                let edges = guarded.map(|guides| of_color_and_guides(plan, *image, &guides, &options));
                let propagation = Propagation { gain, threshold: self.tau_v, edges };
                merged = propagate_colour::pass(plan, *image, colour, deviations, &propagation);
            }
            let mut orientation = match (tensor, below) {
                (Some(tensor), _) if k == 0 => tensor,
                (_, below) => {
                    let own = structure_tensor::of_color(plan, merged, &options);
                    below.map_or(own, |[.., coarse]| propagate_tensor::pass(plan, own, coarse))
                }
            };
            if let (0, Some(flow)) = (k, self.flow) {
                orientation = flow.bend(plan, orientation);
            }
            let filter = match self.weights {
                Weights::Texture => texture::pass,
                Weights::Polynomial => polynomial::pass,
            };
            let colour = filter(plan, merged, orientation, &self.options);
            below = Some([colour, plan.sibling(colour, 1), orientation]);
        }
        below.map_or(color, |[colour, ..]| colour)
    }
}

/// Most scales.
const MAX_LEVELS: usize = 8;

/// Levels whose sides are at most this are not halved again, pixels.
const SMALLEST: i32 = 8;
