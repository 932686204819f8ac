//! The bilateral filter of styles (§ 4.6): regions of like colour become flat, borders stay.

use crate::declare::choice::choice;
use crate::declare::spec::{Param, Scope};
use crate::kernels::colour::rgb_to_lab;
use crate::kernels::smoothing::bilateral::Options;
use crate::kernels::structure::orientation_field;
use crate::stages::bilateral::{self, Kernel};
use crate::stages::control::{Control, Directed};
use crate::stages::steady::{Agreement, COLOUR_AGREEMENT, steadied};
use crate::stages::tensor_options::TensorOptions;
use crate::stages::{ADVANCED, LOOK, flow_bilateral, flow_map, oriented_bilateral, structure_tensor};
use isophote_engine::{ImageId, PlanBuilder};

pub(crate) const DETAIL: Param = Param::float("detail", "Detail", 0.5, [0.0, 1.0])
    .group(LOOK)
    .hint("How much of the picture's detail stays: low values give flat areas, high ones keep small things.")
    .doc("Scales `sigma_r` from 3 to 1/3 times and `sigma_d` from 2 to 1/2.");
pub(crate) const ABSTRACTION: Param = Param::choice(
    "abstraction",
    "Smoothing method",
    Filter::Oriented.selected(),
)
.group(ADVANCED)
.hint("How colours are flattened: along the edges, along flowing lines, or in all directions alike.")
.doc(
    "Bilateral filter: across and along the local orientation (3.4), or along stream lines (3.5), whose \
         own scales then grow with `sigma_d` / 3 and `sigma_r` / 4.25; or without regard to it, by the full \
         window (3.2) or along rows and then columns (3.3).",
);
/// Iterations of styles whose regions are all that they abstract.
pub(crate) const N_A: Param = Param::int("n_a", "Smoothing rounds", 4, [0, 16])
    .slider(0.0, 8.0)
    .structural()
    .group(ADVANCED)
    .hint("How often the colours are smoothed: more rounds give flatter areas.")
    .doc("Bilateral iterations (n_a).");
pub(crate) const SIGMA_D: Param = Param::length("sigma_d", "Smoothing reach", 3.0, [0.1, 20.0])
    .slider(0.5, 10.0)
    .group(ADVANCED)
    .hint("How far colours are smoothed over what is around them.")
    .doc("Spatial standard deviation of the bilateral filter.");
pub(crate) const SIGMA_R: Param = Param::float("sigma_r", "Colour tolerance", 4.25, [0.1, 200.0])
    .slider(0.5, 30.0)
    .group(ADVANCED)
    .hint("How different colours may be and still be smoothed into one.")
    .doc("Standard deviation of the bilateral filter in range, CIELAB units.");

choice! {
    /// The bilateral filter.
    enum Filter {
        /// Across and along the edges.
        Oriented ("oriented", "Along edges"),
        /// Across the edges and along flowing lines.
        Flow ("flow", "Along flowing lines"),
        /// In all directions alike.
        Full ("full", "All directions"),
        /// Along rows and then columns.
        Separable ("xy", "Rows, then columns"),
    }
}

/// The bilateral filter of a style; lengths in pixels of the picture that is rendered.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Abstraction {
    /// Along the local orientation (3.4).
    Oriented(oriented_bilateral::Passes),
    /// Along stream lines (3.5).
    Flow(flow_bilateral::Passes),
    /// Isotropic (3.2), or separable along x and y (3.3).
    Isotropic(bilateral::Passes),
}

impl Abstraction {
    /// The values of `advanced`, scaled by `detail`.
    pub(crate) fn of(scope: &Scope<'_>) -> Self {
        Self::tolerant(scope, 1.0)
    }

    /// The same with a `sigma_r` of `tolerance` times that.
    fn tolerant(scope: &Scope<'_>, tolerance: f32) -> Self {
        Self::scaled(scope, scope.float(DETAIL.id), tolerance)
    }

    /// The values of `advanced`, scaled by a detail of 0..=1 that is no parameter.
    pub(crate) fn with_detail(scope: &Scope<'_>, detail: f32) -> Self {
        Self::scaled(scope, detail, 1.0)
    }

    fn scaled(scope: &Scope<'_>, detail: f32, tolerance: f32) -> Self {
        let [d, r] = detail_factors(detail);
        let (sigma_d, sigma_r) = (scope.float("sigma_d") * d, scope.float("sigma_r") * r * tolerance);
        let isotropic = |kernel| {
            let options = Options { sigma_d, sigma_r, cutoff: bilateral::CUTOFF.default_float() };
            Self::Isotropic(bilateral::Passes { kernel, options })
        };
        match scope.option("abstraction") {
            Filter::Full => isotropic(Kernel::Full),
            Filter::Separable => isotropic(Kernel::Separable),
            Filter::Flow => {
                let mut passes = flow_bilateral::Passes::default();
                let (d, r) = (sigma_d / SIGMA_D.default_float(), sigma_r / SIGMA_R.default_float());
                passes.gradient.sigma_d *= d;
                passes.gradient.sigma_r *= r;
                passes.flow.sigma_d *= d;
                passes.flow.sigma_r *= r;
                Self::Flow(passes)
            }
            Filter::Oriented => {
                let mut passes = oriented_bilateral::Passes::default();
                for options in [&mut passes.gradient, &mut passes.tangent] {
                    (options.sigma_d, options.sigma_r) = (sigma_d, sigma_r);
                }
                Self::Oriented(passes)
            }
        }
    }

    /// A Lab image after `iterations`, with more or less detail along the edges where `control` says so.
    pub(crate) fn apply(
        &self,
        plan: &mut PlanBuilder,
        [lab, tensor]: [ImageId; 2],
        control: Control,
        iterations: i32,
    ) -> ImageId {
        (0..iterations).fold(lab, |lab, _| match self {
            Self::Oriented(passes) => {
                // Nothing is elongated.
                let field = orientation_field::pass(plan, tensor);
                let Directed { field, scaled } = control.detailed(plan, field);
                oriented_bilateral::iteration(plan, lab, field, &passes.scaled(scaled))
            }
            Self::Flow(passes) => flow_bilateral::iteration(plan, lab, tensor, passes),
            Self::Isotropic(passes) => bilateral::iteration(plan, lab, passes),
        })
    }
}

/// The picture after `n_a` iterations, in CIELAB, and the tensors that they follow, both steady over time.
pub(crate) fn steady_regions(scope: &mut Scope<'_>, options: &TensorOptions) -> [ImageId; 2] {
    steadied(scope, Agreement::lab(COLOUR_AGREEMENT), |scope| regions(scope, options, 1.0))
}

/// The same of the frame by itself, where `sigma_r` is `tolerance` times what the parameters say.
pub(crate) fn regions(scope: &mut Scope<'_>, options: &TensorOptions, tolerance: f32) -> [ImageId; 2] {
    let abstraction = Abstraction::tolerant(scope, tolerance);
    regions_by(scope, options, &abstraction)
}

/// The same by a filter of its own.
pub(crate) fn regions_by(
    scope: &mut Scope<'_>,
    options: &TensorOptions,
    abstraction: &Abstraction,
) -> [ImageId; 2] {
    let n_a = scope.int(N_A.id);
    let color = scope.required("color");
    let tensors = structure_tensor::of_color(scope.plan, color, options);
    let tensors = flow_map::bent(scope, tensors);
    let lab = rgb_to_lab::pass(scope.plan, color, 1.0);
    let control = Control::of(scope);
    [abstraction.apply(scope.plan, [lab, tensors], control, n_a), tensors]
}

/// Factors on (`sigma_d`, `sigma_r`) for `detail` 0..=1, 1 at the default.
pub(crate) fn detail_factors(detail: f32) -> [f32; 2] {
    let exponent = 2.0 * (DETAIL.default_float() - detail);
    [2f32.powf(exponent), 3f32.powf(exponent)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_detail_changes_nothing_and_more_smooths_less() {
        assert_eq!(detail_factors(DETAIL.default_float()), [1.0, 1.0]);
        for i in 0..100 {
            let [a, b] = [i, i + 1].map(|i| detail_factors(i as f32 / 100.0));
            assert!(a[0] > b[0] && a[1] > b[1]);
        }
    }
}
