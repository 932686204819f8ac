//! Importance of places, found in a picture: clear and sharp shapes in place of texture and blur, and what is near the middle.

use crate::declare::spec::{CENTRE, Scope};
use crate::kernels::colour::rgb_to_lab;
use crate::kernels::smoothing::gaussian_blur;
use crate::kernels::structure::clear_structure::{self, Params};
use crate::kernels::structure::gradient_tensor::{self, Derivative, Measure};
use crate::kernels::structure::importance::{self, Middle};
use crate::kernels::structure::{colour_restrict, tensor_interpolate, tensor_restrict};
use crate::stages::line_context::surroundings;
use isophote_engine::{Class, ImageId};

/// Levels from fine gradients to coarse ones.
const OCTAVES: usize = 2;
/// Most levels of the pyramid below the coarse gradients: pictures up to 32 times as large as the full one.
const MOST_LEVELS: usize = 9;
/// Standard deviations, pixels of the full picture: of the window in which gradients are compared, and of what is around.
const WINDOW: f32 = 10.0;
const AROUND: f32 = 48.0;
/// Gradient that counts half, units of CIELAB a hundred a pixel of the full picture.
const HALF_GRADIENT: f32 = 0.008;
/// Standard deviation of the Gaussian around the middle, of half the diagonal.
const MIDDLE: f32 = 0.6;

/// Importance of the places of a node's picture, one channel, 0..=1. The node has the parameter [`CENTRE`].
pub(crate) fn importance(scope: &mut Scope<'_>) -> ImageId {
    let (scale, share) = (scope.scale(), scope.float(CENTRE.id));
    let color = scope.required("color");
    let plan = &mut *scope.plan;
    // Plans are described without allocating.
    let mut levels = [rgb_to_lab::pass(plan, color, 1.0); MOST_LEVELS];
    // Fine pixels are two of the full picture's wide, so that its proxies of half the size see the same. Smaller ones have none
    // as fine, and enlarged pictures finer ones.
    let first = (2.0 * scale).log2().round().clamp(0.0, (MOST_LEVELS - 1 - OCTAVES) as f32) as usize;
    let last = first + OCTAVES;
    for level in 1..=last {
        levels[level] = colour_restrict::pass(plan, levels[level - 1]);
    }
    let measure = Measure { scale: 0.01, luma: false, normalize: false, threshold: None };
    let mut gradients =
        [first, last].map(|level| gradient_tensor::pass(plan, levels[level], Derivative::Scharr3, measure));
    for _ in first..last {
        gradients[0] = tensor_restrict::pass_mean(plan, gradients[0]);
    }
    let size = scale / (1_u32 << last) as f32;
    let means = gradients.map(|tensor| gaussian_blur::pass(plan, tensor, WINDOW * size, Class::Field));
    let wider = (1_u32 << OCTAVES) as f32;
    let half_gradient = HALF_GRADIENT * (1_u32 << first) as f32 / scale;
    let params = Params { area: 1.0 / (wider * wider), ratio: wider, half_gradient };
    let clear = clear_structure::pass(plan, means, &params);
    let mut found = surroundings(plan, clear, AROUND * size);
    for level in levels[..last].iter().rev() {
        found = tensor_interpolate::pass_to(plan, *level, found);
    }
    let [width, height] = plan.size().map(|n| n as f32);
    let sigma = MIDDLE * 0.5 * width.hypot(height);
    importance::pass(plan, found, &Middle { at: [0.5 * width, 0.5 * height], sigma, share })
}
