//! Brush strokes in layers from coarse to fine (Hertzmann 1998): finer ones paint only where the picture has detail of their
//! size. Seeds are points that belong to things, so that strokes move with what they paint.

use crate::declare::spec::Scope;
use crate::kernels::smoothing::gaussian_blur;
use crate::kernels::strokes::stroke_fade;
use crate::kernels::strokes::stroke_paint::{self, Paint};
use crate::kernels::strokes::stroke_points::{self, Anchor, Points};
use crate::kernels::strokes::stroke_seeds::{self, Inputs, Strokes};
use crate::stages::control::Control;
use crate::stages::marks;
use isophote_engine::ImageId;
use std::f32::consts::PI;

/// A brush, and how it is used; lengths in pixels of the picture that is rendered.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Brush {
    /// Sizes of strokes, each half of the one before.
    pub layers: i32,
    /// Half the width of strokes of the third layer.
    pub half_width: f32,
    /// Half their length.
    pub half_length: f32,
    /// Share of the field's bend that strokes follow, 0..=1.
    pub curve: f32,
    /// Share of the picture's detail that is painted, 0..=1.
    pub detail: f32,
    /// Distance along a stroke at which colours count half.
    pub smoothing: f32,
    /// Difference between the colours of strokes, 0..=1.
    pub variation: f32,
    /// Share of a stroke that the paint does not cover, 0..=1.
    pub dryness: f32,
    /// Raggedness of the ends of strokes, 1 at the middle of a control.
    pub raggedness: f32,
    /// Width and length of the marks of bristles.
    pub bristles: [f32; 2],
    /// Number of the noise that strokes begin with.
    pub seed: u32,
}

/// Images that are painted after.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Subject {
    /// The picture, Lab.
    pub picture: ImageId,
    /// Tensors that strokes follow.
    pub tensors: ImageId,
    /// Object ids, where they are known.
    pub ids: Option<ImageId>,
}

/// Most layers that there may be.
const MOST_LAYERS: usize = 4;
/// Strokes over each place, layer by layer: the first has to cover all.
const DENSITY: [f32; 2] = [4.5, 3.5];
/// Standard deviation of the smoothing that leaves what strokes of a layer can show, in half their widths (Hertzmann's f_sigma
/// is 0.5 of a brush's radius).
const SMOOTH: f32 = 0.6;
/// Difference of colour, Lab, at which strokes end, and from which on finer ones are wanted at the middle of `detail`.
const TOLERANCE: f32 = 14.0;
const THRESHOLD: f32 = 6.0;
/// Largest differences of lightness (L) and hue (radians) from stroke to stroke.
const MOST_VARIATION: [f32; 2] = [10.0, 0.35];
/// Share of a stroke's end that is ragged.
const RAGGED: f32 = 0.45;
/// Heights of the middle of strokes and of the marks of bristles.
const HEIGHTS: [f32; 2] = [0.25, 0.65];
/// Pixels of the full-size picture over which borders of strokes are soft.
const SOFTNESS: f32 = 1.2;

/// Pixels of the finest marks of bristles.
const FINEST: f32 = 1.0;
/// Half lengths below which there are no strokes, pixels.
const LEAST: f32 = 0.5;

/// The picture painted in strokes, Lab, and the heights of the paint; none where strokes are too short to be any.
pub(crate) fn painted(scope: &mut Scope<'_>, subject: &Subject, brush: &Brush) -> Option<[ImageId; 2]> {
    if brush.half_length < LEAST || brush.half_width < 0.5 * LEAST {
        return None;
    }
    let mut smooth = [None; MOST_LAYERS];
    let (anchor, other) = marks::anchors(scope);
    let first = layered(scope, subject, brush, anchor, &mut smooth)?;
    let Some((anchor, share)) = other else { return Some(first) };
    let second = layered(scope, subject, brush, anchor, &mut smooth)?;
    Some(stroke_fade::pass(scope.plan, subject.picture, [first, second], share))
}

/// All layers of strokes that belong to `anchor`; `smooth` takes the smooth pictures that are not there yet.
fn layered(
    scope: &mut Scope<'_>,
    subject: &Subject,
    brush: &Brush,
    anchor: Anchor,
    smooth: &mut [Option<ImageId>; MOST_LAYERS],
) -> Option<[ImageId; 2]> {
    let mut below = None;
    let mut coarse = None;
    for (number, smooth) in smooth.iter_mut().enumerate().take(brush.layers.max(1) as usize) {
        let smooth = *smooth.get_or_insert_with(|| {
            let sigma = SMOOTH * size_of(number) * brush.half_width;
            gaussian_blur::pass_colour(scope.plan, subject.picture, sigma)
        });
        below = Some(layer(scope, subject, brush, anchor, (number, smooth), below.zip(coarse)));
        coarse = Some(smooth);
    }
    below
}

/// Size of strokes of a layer against those of the third.
fn size_of(layer: usize) -> f32 {
    2f32.powi(2 - layer as i32)
}

/// A layer of strokes. But for the first one it lies on another, of which the smooth picture is given too, and only where the
/// picture has detail that strokes of that one cannot show. Detail decides, not the colours that coarse strokes happen to
/// have: it moves with things.
fn layer(
    scope: &mut Scope<'_>,
    subject: &Subject,
    brush: &Brush,
    anchor: Anchor,
    (number, smooth): (usize, ImageId),
    below: Option<([ImageId; 2], ImageId)>,
) -> [ImageId; 2] {
    let origin = scope.origin();
    let size = size_of(number);
    let (half_width, half_length) = (size * brush.half_width, size * brush.half_length);
    let density = DENSITY[usize::from(number > 0)];
    let apart = (4.0 * half_width * half_length / (PI * density)).sqrt();
    let seed = brush.seed.wrapping_add(number as u32 * 0x51ed_270b);
    let points = stroke_points::pass(scope.plan, subject.picture, anchor, &Points { apart, origin, seed });
    let control = Control::of(scope);
    let coarse = below.map(|(_, coarse)| control.contrasted(scope.plan, [subject.picture, coarse]));
    let inputs = Inputs {
        points,
        tensors: subject.tensors,
        picture: subject.picture,
        smooth,
        coarse,
        ids: subject.ids,
    };
    let strokes = Strokes {
        origin,
        half_width,
        half_length,
        apart,
        curve: brush.curve,
        tolerance: TOLERANCE * [1.3, 1.0, 0.8][number.min(2)],
        threshold: THRESHOLD * 8f32.powf(0.5 - brush.detail),
        smoothing: size * brush.smoothing,
        variation: brush.variation * MOST_VARIATION[0],
        hue_variation: brush.variation * MOST_VARIATION[1],
    };
    let seeds = stroke_seeds::pass(scope.plan, &inputs, &strokes);
    let [bristle, bristle_length] = brush.bristles;
    let paint = Paint {
        origin,
        half_width,
        half_length,
        bristles: [bristle.max(FINEST), bristle_length.max(FINEST)],
        ragged: RAGGED * brush.raggedness,
        dryness: brush.dryness,
        // Finer ones than pixels can show are as faint as from further away.
        heights: [HEIGHTS[0], HEIGHTS[1] * (bristle / FINEST).min(1.0)],
        softness: (SOFTNESS * scope.scale()).max(1.0),
    };
    let ground = below.map_or((subject.picture, None), |([picture, heights], _)| (picture, Some(heights)));
    stroke_paint::pass(scope.plan, seeds, ground, subject.ids, &paint)
}
