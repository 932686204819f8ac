//! Structure tensors (§ 2.2-2.4, 2.7.3, 2.8) for nodes that follow them; equal passes are shared by the plan.

use crate::kernels::colour::rgb_to_lab;
use crate::kernels::smoothing::gaussian_blur;
use crate::kernels::structure::gradient_tensor::{self, Measure};
use crate::kernels::structure::{
    colour_restrict, guide_tensor, jacobi_step, oversampled_tensor, tensor_combine, tensor_restrict,
};
use crate::spec::Scope;
use crate::stages::flow_map;
use crate::stages::tensor_options::{Guides, Space, TensorOptions};
use isophote_engine::{Class, ImageId, PlanBuilder};

/// The tensor connected to the port `tensor` of a node or, where none is, that of `color` with the
/// defaults, bent to what is connected to its port `flow`.
pub fn connected(scope: &mut Scope<'_>, color: ImageId) -> ImageId {
    let tensors = match scope.input("tensor") {
        Some(tensor) => tensor,
        None => of_color(scope.plan, color, &TensorOptions::at_scale(scope.scale())),
    };
    flow_map::bent(scope, tensors)
}

/// [`connected`] for nodes that say by `rho` how their own tensor is smoothed.
pub fn connected_or_smoothed(scope: &mut Scope<'_>, color: ImageId) -> ImageId {
    let tensors = match scope.input("tensor") {
        Some(tensor) => tensor,
        None => {
            let options = TensorOptions { rho: scope.float("rho"), ..TensorOptions::at_scale(scope.scale()) };
            of_color(scope.plan, color, &options)
        }
    };
    flow_map::bent(scope, tensors)
}

/// The smoothed tensor of a colour.
pub fn of_color(plan: &mut PlanBuilder, color: ImageId, options: &TensorOptions) -> ImageId {
    of_color_and_guides(plan, color, &Guides::default(), options)
}

/// The smoothed tensor of a colour and of the guides that there are.
pub fn of_color_and_guides(
    plan: &mut PlanBuilder,
    color: ImageId,
    guides: &Guides,
    options: &TensorOptions,
) -> ImageId {
    let threshold = (options.relax_threshold > 0.0).then_some(options.relax_threshold);
    let (source, scale) = match options.space {
        Space::Lab => (rgb_to_lab::pass(plan, color, 1.0), 0.01),
        Space::Rgb | Space::Luminance => (color, 1.0),
    };
    let measure =
        Measure { scale, luma: options.space == Space::Luminance, normalize: options.normalize, threshold };
    over_levels(plan, source, guides, options, measure, options.levels)
}

/// The result of this level and `levels` - 1 coarser ones (2.172).
fn over_levels(
    plan: &mut PlanBuilder,
    source: ImageId,
    guides: &Guides,
    options: &TensorOptions,
    measure: Measure,
    levels: i32,
) -> ImageId {
    let own = smoothed(plan, source, guides, options, measure);
    if levels <= 1 || plan.level_size(plan.desc(source).level) == [1, 1] {
        return own;
    }
    let coarse = colour_restrict::pass(plan, source);
    let coarse = over_levels(plan, coarse, &Guides::default(), options, measure, levels - 1);
    tensor_combine::pass(plan, own, coarse)
}

/// The smoothed tensor of one level.
fn smoothed(
    plan: &mut PlanBuilder,
    source: ImageId,
    guides: &Guides,
    options: &TensorOptions,
    measure: Measure,
) -> ImageId {
    let mut rho = options.smoothing();
    let mut tensor = match options.oversample {
        Some(sigma) => oversampled_tensor::pass(plan, source, sigma, measure),
        None => gradient_tensor::pass(plan, source, options.derivative, measure),
    };
    let relax = |plan: &mut PlanBuilder, tensor| match measure.threshold {
        Some(_) => jacobi_step::relax(plan, tensor, options.relax_steps),
        None => tensor,
    };
    if options.oversample.is_some() {
        // The mean of four adds 1/16 of a pixel to the variance of the window.
        rho = (rho * rho - 0.0625).max(0.0).sqrt();
        if guides.each().next().is_none() {
            // Smoothing comes before the samples are thinned out, or they would alias.
            let relaxed = relax(plan, tensor);
            let wide = gaussian_blur::pass(plan, relaxed, 2.0 * rho, Class::Field);
            return tensor_restrict::pass_mean(plan, wide);
        }
        // Guides have the picture's own pixels.
        tensor = tensor_restrict::pass_mean(plan, tensor);
    }
    for (kind, guide) in guides.each() {
        let guide_options =
            guide_tensor::Options { kind, weight: options.guide_weight, threshold: measure.threshold };
        tensor = guide_tensor::pass(plan, tensor, guide, &guide_options);
    }
    let relaxed = relax(plan, tensor);
    gaussian_blur::pass(plan, relaxed, rho, Class::Field)
}
