//! Paper that a host gives: its colours, and its grain by what is lighter and darker than the paper around it, so that
//! stains and uneven light are no grain.

use crate::declare::ports::PAPER;
use crate::declare::spec::Scope;
use crate::kernels::colour::{lightness, paper_relief};
use crate::kernels::lines::lightness_moments;
use crate::kernels::smoothing::gaussian_blur;
use isophote_engine::{Class, ImageId};

/// Standard deviation of the window that is around a place of the paper, pixels of the full-size picture: some threads
/// of a canvas, or some of the lines of laid paper.
const AROUND: f32 = 16.0;

/// The paper that is connected to a node: RGB on white, and the depth of its grain.
pub(crate) fn given(scope: &mut Scope<'_>) -> Option<ImageId> {
    let [paper, lightness, moments] = seen(scope)?;
    let around = gaussian_blur::pass(scope.plan, moments, AROUND * scope.scale(), Class::Field);
    Some(paper_relief::pass(scope.plan, paper, [lightness, around]))
}

/// Its colours alone: RGB on white, for sheets without grain.
pub(crate) fn colours(scope: &mut Scope<'_>) -> Option<ImageId> {
    let [paper, lightness, moments] = seen(scope)?;
    // Nothing around it counts for its colours.
    Some(paper_relief::pass(scope.plan, paper, [lightness, moments]))
}

/// The paper, its lightness, and the moments of that.
fn seen(scope: &mut Scope<'_>) -> Option<[ImageId; 3]> {
    let paper = scope.input(PAPER.id)?;
    let lightness = lightness::pass(scope.plan, paper);
    Some([paper, lightness, lightness_moments::pass(scope.plan, lightness)])
}
