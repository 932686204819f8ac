//! Marks of hand and brush that belong to things: noise at rest positions, where they are known, else noise that motion
//! carries, else noise on the screen. Paper stays on the screen.

use crate::declare::ports::REST_POSITION;
use crate::declare::spec::Scope;
use crate::kernels::smoothing::gaussian_blur;
use crate::kernels::smoothing::line_blur::{self, Lines};
use crate::kernels::strokes::stroke_points::Anchor;
use crate::kernels::structure::smooth_noise::{self, Layer};
use crate::kernels::structure::solid_noise::{self, Marks};
use crate::kernels::structure::{noise, rest_footprint, rest_scale};
use crate::kernels::time::carried_noise::{self, Layers};
use crate::kernels::time::mark_chain::{self, Step};
use isophote_engine::{Class, ImageId, math};

/// White noise, smoothed by `sigma` pixels of the picture that is rendered.
pub(crate) fn grains(scope: &mut Scope<'_>, sigma: f32, seed: u32) -> ImageId {
    let (scale, origin) = (scope.scale(), scope.origin());
    let screen = |scope: &mut Scope<'_>, seed: u32| {
        let white = noise::pass(scope.plan, scale, origin, seed);
        gaussian_blur::pass(scope.plan, white, sigma, Class::Colour)
    };
    on_things(scope, screen, &Marks::of_smoothed_noise(sigma, scale, seed))
}

/// Anchor of strokes and other marks with places of their own; where motion carries them, two layers that fade into
/// one another, and the share of the second one.
pub(crate) fn anchors(scope: &mut Scope<'_>) -> (Anchor, Option<(Anchor, f32)>) {
    if let Some(points) = scope.input(REST_POSITION.id) {
        let footprints = rest_footprint::pass(scope.plan, points);
        return (Anchor::Rest { points, scales: rest_scale::pass(scope.plan, points, footprints) }, None);
    }
    let Some(Carried { chain, share, lives, .. }) = chain(scope) else { return (Anchor::Screen, None) };
    let [first, second] =
        [false, true].map(|second| Anchor::Carried { chain, second, life: lives[usize::from(second)] });
    (first, Some((second, share)))
}

/// Clouds of the size of those of the screen; none where they are to stay there. Of both `layers` together marks on
/// things have one size.
pub(crate) fn clouds(scope: &mut Scope<'_>, layers: [Layer; 2]) -> Option<ImageId> {
    if !belong_to_things(scope) {
        return None;
    }
    let (scale, origin) = (scope.scale(), scope.origin());
    let screen = |scope: &mut Scope<'_>, number: u32| {
        let layers =
            layers.map(|(f, share, seed)| (f, share, seed.wrapping_add(number).wrapping_sub(layers[0].2)));
        smooth_noise::pass(scope.plan, layers, scale, origin)
    };
    // Standard deviation of the smooth step between cells, in cells.
    const WIDTH: f32 = 0.365;
    // Standard deviation of the smoothing at silhouettes, pixels of the full-size picture.
    const BORDER: f32 = 4.0;
    let [(f, a, seed), (g, b, _)] = layers;
    let sigma = WIDTH * (a / f + b / g) / (a + b);
    let marks = Marks { sigma: sigma * scale, deviation: deviation(layers), seed };
    let clouds = on_things(scope, screen, &marks);
    // Outlines waver, and clouds of things must not end beside them; leaves make no crumbs.
    Some(gaussian_blur::pass(scope.plan, clouds, BORDER * scale, Class::Colour))
}

/// The same, and where they are to stay on the screen its own: smooth noise, 0..=1 about the half of both shares.
pub(crate) fn waves(scope: &mut Scope<'_>, layers: [Layer; 2]) -> ImageId {
    clouds(scope, layers).unwrap_or_else(|| {
        let (scale, origin) = (scope.scale(), scope.origin());
        smooth_noise::pass(scope.plan, layers, scale, origin)
    })
}

/// Standard deviation of the values of smooth noise of two layers.
pub(crate) fn deviation([(_, a, _), (_, b, _)]: [Layer; 2]) -> f32 {
    // That of a layer whose share is 1.
    const DEVIATION: f32 = 0.2144;
    DEVIATION * math::hypot(a, b)
}

/// Standard deviation of the heights of [`hatching`].
pub(crate) const HATCHING_DEVIATION: f32 = 0.28;

/// Heights of strokes in two directions, 0..=1, about `spacing` pixels of the full-size picture apart, which moving things
/// do not make flicker as thinner ones would; none where they are to stay on the screen.
pub(crate) fn hatching(
    scope: &mut Scope<'_>,
    directions: [[f32; 2]; 2],
    spacing: f32,
    seed: u32,
) -> Option<[ImageId; 2]> {
    // Standard deviation along strokes, pixels of the full-size picture, and that across, in spacings.
    const ALONG: f32 = 13.0;
    const ACROSS: f32 = 0.16;
    // Wider ones do not follow what turns away.
    const WIDEST: f32 = 1.2;
    if !belong_to_things(scope) {
        return None;
    }
    let (scale, across) = (scope.scale(), (ACROSS * spacing).min(WIDEST));
    let soft = grains(scope, across * scale, seed);
    let Marks { deviation, .. } = Marks::of_smoothed_noise(across * scale, scale, seed);
    // A Gaussian along lines leaves this share of the deviation.
    let left = (across / math::hypot(ALONG, across)).sqrt();
    let gain = HATCHING_DEVIATION / (deviation * left);
    let step = (1.5 * scale).max(1.0);
    Some(directions.map(|direction| {
        let lines = Lines { direction, step, sigma: ALONG * scale, gain };
        line_blur::pass(scope.plan, soft, &lines)
    }))
}

/// True where marks move with things.
fn belong_to_things(scope: &Scope<'_>) -> bool {
    scope.input(REST_POSITION.id).is_some() || (scope.renewal().is_some() && scope.input("motion").is_some())
}

/// The noise that `screen` makes of a seed, and noise of the same looks that moves with things where their rest positions
/// are known.
fn on_things(
    scope: &mut Scope<'_>,
    screen: impl Fn(&mut Scope<'_>, u32) -> ImageId,
    marks: &Marks,
) -> ImageId {
    let Some(points) = scope.input(REST_POSITION.id) else { return carried(scope, screen, marks) };
    let footprints = rest_footprint::pass(scope.plan, points);
    let scales = rest_scale::pass(scope.plan, points, footprints);
    let screen = screen(scope, marks.seed);
    solid_noise::pass(scope.plan, points, scales, screen, marks)
}

/// Motions that marks are carried at most, in units of the longest motion from frame to frame: farther ones, which nobody
/// can follow, would make tiles read much of the picture.
const FARTHEST: f32 = 2.0;

/// Motion of the frames before, added up for two layers.
struct Carried {
    chain: ImageId,
    /// Share of the second layer.
    share: f32,
    /// Farthest on each axis that marks are carried, pixels.
    farthest: f32,
    /// Number of the life that each layer is in, odd for the first and even for the second.
    lives: [u32; 2],
}

/// The motion of the frames before for two layers of marks, half a period apart, each of which begins anew when the other one
/// alone is seen; none where marks stay on the screen. The number of the frame decides when, so that frames in any order
/// show the same.
fn chain(scope: &mut Scope<'_>) -> Option<Carried> {
    let (period, frame) = scope.renewal()?;
    let since = [0, period / 2].map(|offset| frame + i64::from(offset));
    let ages = since.map(|frames| frames.rem_euclid(i64::from(period)) as i32);
    let lives = [0, 1].map(|n| {
        let before = since[n].div_euclid(i64::from(period)) as u32;
        before.wrapping_mul(2).wrapping_add(n as u32 + 1)
    });
    let longest = scope.max_motion;
    let farthest = longest * FARTHEST;
    let mut chain = None;
    // All steps are always there, so that another frame is another set of numbers in the same passes.
    for count in 0..period - 1 {
        let Some(motion) = scope.motion_before(count) else { break };
        let advance = ages.map(|age| count < age);
        let step = Step { longest, farthest, count: count as u32, advance };
        chain = Some(mark_chain::pass(scope.plan, chain, motion, &step));
    }
    // A triangle: 1 in the middle of a layer's life, 0 at its ends.
    let share = 1.0 - (2.0 * ages[1] as f32 / period as f32 - 1.0).abs();
    chain.map(|chain| Carried { chain, share, farthest, lives })
}

/// The noise that `screen` makes of a seed, carried along the motion of the frames before in two layers.
fn carried(scope: &mut Scope<'_>, screen: impl Fn(&mut Scope<'_>, u32) -> ImageId, marks: &Marks) -> ImageId {
    let common = screen(scope, marks.seed);
    let Some(Carried { chain, share, farthest, .. }) = chain(scope) else { return common };
    let layers = Layers { share, sigma: marks.sigma, farthest };
    let [first, second] =
        [1, 2].map(|n: u32| screen(scope, marks.seed.wrapping_add(n.wrapping_mul(0x9e37_79b9))));
    carried_noise::pass(scope.plan, [common, first, second], chain, &layers)
}
