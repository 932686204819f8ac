//! Stages that are carried from neighbouring frames along motion and averaged, which keeps styles from exaggerating what
//! flickers: lines, tones and marks that one frame draws and the next one does not fade in and out.
//!
//! Every stage is found on each frame by itself, so that a frame depends on a finite window of frames and stages can be
//! kept from frame to frame. Lines and tones are decided there too: an average of what they are decided by changes less, but
//! is decided anew in each frame, and all at once. Paper is laid under the averages; it stays on the screen. A neighbour
//! counts by a Gaussian over time, times the agreement of its smoothed colour, of depth, of object numbers, and of
//! forward with backward motion, where there are such.

use crate::declare::spec::{STEADINESS, Scope, WINDOW};
use crate::kernels::smoothing::gaussian_blur;
use crate::kernels::time::carried_share::{self, Neighbour};
use crate::kernels::time::guide_agreement::{self, Guide, Way};
use crate::kernels::time::{
    carry_colour, carry_tensor, carry_value, motion_chain, motion_import, return_agreement,
};
use isophote_engine::{Class, ImageId};

/// Measure by which colours of frames are compared.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Agreement {
    /// Standard deviation of the Gaussian over differences of colour.
    pub sigma: f32,
    /// Difference of colour that a difference of alpha of 1 counts as.
    pub alpha: f32,
}

impl Agreement {
    /// In CIELAB, by a standard deviation in its units.
    pub const fn lab(sigma: f32) -> Self {
        Self { sigma, alpha: 100.0 }
    }

    /// In gamma-encoded RGB, where differences are about a hundredth of those in CIELAB.
    pub const fn rgb(sigma: f32) -> Self {
        Self { sigma: 0.01 * sigma, alpha: 1.0 }
    }
}

/// Standard deviation of the Gaussian over differences of colour, CIELAB units.
pub(crate) const COLOUR_AGREEMENT: f32 = 8.0;

/// Standard deviation of the smoothing of pictures before they are compared, pixels: noise must not look like change.
const SMOOTHING: f32 = 1.5;

/// Images that `describe` finds on the frame that is described, steadied by what it finds on its neighbours as the
/// parameters `steadiness` and `window` say.
///
/// The first image is a picture, by which frames are compared as `by` says; the others are colours of
/// any kind, structure tensors (fields of four channels), or values of 0..=1 (one channel).
pub(crate) fn steadied<const N: usize>(
    scope: &mut Scope<'_>,
    by: Agreement,
    describe: impl Fn(&mut Scope<'_>) -> [ImageId; N],
) -> [ImageId; N] {
    let own = describe(scope);
    let steadiness = scope.float(STEADINESS.id);
    let moves = scope.input("motion").is_some() || scope.input("motion_forward").is_some();
    let window = if steadiness > 0.0 && moves { scope.int(WINDOW.id) } else { 0 };
    if window == 0 {
        return own;
    }
    let stages = kept(scope, own);
    let (mut average, mut shares) = (own, None);
    for offset in scope.neighbours(window) {
        let Some(way) = way_to(scope, offset) else { continue };
        let theirs = if scope.is_handed(offset) {
            scope.at(offset, |scope| {
                let mut handed = own;
                for (image, stage) in handed.iter_mut().zip(stages) {
                    *image = scope.handed(stage, *image);
                }
                handed
            })
        } else {
            scope.at(offset, |scope| {
                let theirs = describe(scope);
                kept(scope, theirs);
                theirs
            })
        };
        let neighbour = Neighbour {
            motion: way.motion,
            reach: way.reach,
            gain: gain(steadiness, offset),
            sigma: by.sigma,
            alpha: by.alpha,
            weights: agreement(scope, offset, way),
        };
        let share = carried_share::pass(scope.plan, [own[0], theirs[0]], shares, &neighbour);
        for (average, theirs) in average.iter_mut().zip(theirs) {
            let (images, by) = ([*average, theirs], [way.motion, share]);
            let shape = scope.plan.desc(theirs);
            *average = match (shape.class, shape.channels) {
                (_, 1) => carry_value::pass(scope.plan, images, by, way.reach),
                (Class::Field, _) => carry_tensor::pass(scope.plan, images, by, way.reach),
                (Class::Colour, _) => carry_colour::pass(scope.plan, images, by, way.reach),
            };
        }
        shares = Some(share);
    }
    average
}

/// The node's picture, gamma-encoded, steadied before the filter sees it.
pub(crate) fn steadied_picture(scope: &mut Scope<'_>) -> ImageId {
    let [_, color] = steadied(scope, Agreement::rgb(COLOUR_AGREEMENT), |scope| {
        let color = scope.required("color");
        [compared(scope, color), color]
    });
    color
}

/// A picture as it is compared with those of other frames; itself where it is not.
pub(crate) fn compared(scope: &mut Scope<'_>, color: ImageId) -> ImageId {
    if scope.float(STEADINESS.id) <= 0.0 {
        return color;
    }
    let sigma = SMOOTHING * scope.scale();
    gaussian_blur::pass_colour(scope.plan, color, sigma)
}

/// Keeps the stages of the frame that is described, and returns their numbers.
fn kept<const N: usize>(scope: &mut Scope<'_>, images: [ImageId; N]) -> [u32; N] {
    let mut stages = [0; N];
    for (index, (stage, image)) in stages.iter_mut().zip(images).enumerate() {
        *stage = scope.keep(index, image);
    }
    stages
}

/// Weight of a frame so far away: a Gaussian that is 1 for the frame itself and has no width at 0, every width at 1.
fn gain(steadiness: f32, offset: i32) -> f32 {
    steadiness.powf((offset * offset) as f32 / 8.0)
}

/// Way of the points of the frame that is described to another; none where no motion leads there.
fn way_to(scope: &mut Scope<'_>, offset: i32) -> Option<Way> {
    let (port, towards) = if offset < 0 { ("motion", -1) } else { ("motion_forward", 1) };
    let longest = scope.max_motion;
    let mut motion = motion_import::pass(scope.plan, scope.input(port)?, longest);
    for step in 1..offset.abs() {
        let next = scope.at(step * towards, |scope| scope.input(port))?;
        motion = motion_chain::pass(scope.plan, motion, next, longest, step as u32 + 1);
    }
    Some(Way { motion, reach: (longest * offset.abs() as f32).ceil() as u32 })
}

/// Agreement of what is known beside colour between the frame that is described and another; none where nothing is.
fn agreement(scope: &mut Scope<'_>, offset: i32, way: Way) -> Option<ImageId> {
    let mut weights = None;
    for (port, guide) in [("depth", Guide::Depth), ("object_id", Guide::ObjectId)] {
        if let Some(own) = scope.input(port)
            && let Some(theirs) = scope.at(offset, |scope| scope.input(port))
        {
            weights = Some(guide_agreement::pass(scope.plan, [own, theirs], guide, way, weights));
        }
    }
    // Farther motions back would have to be chained in the other frame; the nearest frames count most.
    let back = match offset {
        -1 => "motion_forward",
        1 => "motion",
        _ => return weights,
    };
    if let Some(back) = scope.at(offset, |scope| scope.input(back)) {
        weights = Some(return_agreement::pass(scope.plan, way, back, weights));
    }
    weights
}
