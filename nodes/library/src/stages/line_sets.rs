//! Sets of lines, as illustrators ink them: colours and opacities of their own for outlines, for borders between things that
//! touch, for creases and for what is within surfaces, and gaps where a line ends behind a nearer thing.

use crate::declare::choice::choice;
use crate::declare::ports::LINE_PAINT;
use crate::declare::spec::{Param, Scope};
use crate::kernels::colour::composite_lines::{self, Params as Composite};
use crate::kernels::colour::line_paint::{self, Params as Colours};
use crate::kernels::colour::{given_line_paint, painted_lines};
use crate::kernels::lines::line_taper::{self, Lines};
use crate::kernels::lines::{line_fade, line_gap, line_kinds, occluders};
use crate::kernels::smoothing::disc_extremum::{self, Extremum};
use crate::kernels::smoothing::gaussian_blur;
use crate::kernels::structure::orientation_field;
use crate::stages::flow_dog::{self, FlowDog};
use crate::stages::line_wobble::WOBBLE;
use crate::stages::tensor_options::Guides;
use crate::stages::{ADVANCED, LOOK};
use isophote_engine::{Class, ImageId};

pub(crate) const LINE_COLORS: Param = Param::choice("line_colors", "Line colours", LineColors::One.selected())
    .group(LOOK)
    .hint("One colour for all lines, or one each for outlines, borders, creases and the rest. Needs depth, object ids or normals.")
    .doc(
        "By kind, `line_color` is that of lines that come from the picture itself. A line has the colour of the densest \
         breaks around it.",
    );
pub(crate) const OUTLINE_COLOR: Param =
    Param::color("outline_color", "Outline colour", [0.09, 0.085, 0.1, 1.0])
        .group(LOOK)
        .hint("Colour and opacity of outlines, where line colours are by kind.");
pub(crate) const BORDER_COLOR: Param = Param::color("border_color", "Border colour", [0.36, 0.2, 0.16, 1.0])
    .group(LOOK)
    .hint("Colour and opacity of borders between things that touch, where line colours are by kind.");
pub(crate) const CREASE_COLOR: Param = Param::color("crease_color", "Crease colour", [0.5, 0.25, 0.18, 1.0])
    .group(LOOK)
    .hint("Colour and opacity of creases, where line colours are by kind.");
pub(crate) const LINE_GAP: Param = Param::length("line_gap", "Line gap", 0.0, [0.0, 32.0])
    .slider(0.0, 12.0)
    .structural()
    .group(ADVANCED)
    .hint("How far before the outline of a nearer thing the lines behind it end; 0 for not at all. Needs depth.");

pub(crate) const TAPER: Param = Param::length("taper", "Taper", 0.0, [0.0, 60.0])
    .slider(0.0, 40.0)
    .structural()
    .group(ADVANCED)
    .hint("How long the ends of lines are that run out into a point; 0 for one width to the end. It is seen on wide lines.")
    .doc(
        "Standard deviation, along the direction at each pixel, over which lines are looked at for their ends: places from \
         where they go on to one side alone.",
    );

choice! {
    /// Colours of lines.
    enum LineColors {
        /// One for all.
        One ("one", "One for all"),
        /// One for each kind of lines.
        Kinds ("kinds", "By kind"),
    }
}

/// Distance within which a line has the colour of its kind, in standard deviations of the widest line, and in pixels of the
/// full-size picture beside that: lines are a little wider than what they come from.
const SPREAD: [f32; 2] = [1.5, 1.0];

/// Density of the smoothed breaks in the middle of a lone one, two pixels wide, times the standard deviation.
const PEAK: f32 = 0.798;

/// Half the width of a line, in standard deviations of the widest.
const HALF_LINE: f32 = 1.2;

/// Half the width of an outline, in its standard deviations, and in pixels of the full-size picture beside that.
const HALF_OUTLINE: [f32; 2] = [2.0, 1.0];

/// Most pixels around a line that any of this looks at for its width.
const WIDEST: f32 = 48.0;

/// Standard deviation of the smoothing of the ends at gaps, pixels.
const SOFT_ENDS: f32 = 0.6;

/// Lines that are ready to be drawn.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Inked {
    /// 1 = paper, 0 = line; as faint as kinds of lines are, where they have opacities of their own.
    pub edges: ImageId,
    /// RGB of lines at each pixel, and their opacity, which `edges` have already; none where they have one colour.
    pub paint: Option<ImageId>,
    /// RGB and opacity of all lines; the latter 1 where `edges` have it.
    pub line: [f32; 4],
}

impl Inked {
    /// The edges in the colours that the parameters say.
    pub(crate) fn new(scope: &mut Scope<'_>, flow: &FlowDog, edges: ImageId) -> Self {
        let line = scope.color("line_color");
        let Some(paint) = paint(scope, flow, 1.0, line) else { return Self { edges, paint: None, line } };
        let [r, g, b, _] = line;
        Self { edges: line_fade::pass(scope.plan, edges, paint), paint: Some(paint), line: [r, g, b, 1.0] }
    }

    /// The lines over a picture.
    pub(crate) fn over(&self, scope: &mut Scope<'_>, picture: ImageId) -> ImageId {
        match self.paint {
            Some(paint) => painted_lines::pass(scope.plan, [picture, self.edges, paint]),
            None => {
                let colours = Composite { line: self.line, paper: [0.0; 4] };
                composite_lines::pass(scope.plan, picture, self.edges, &colours)
            }
        }
    }
}

/// RGB and opacity of lines at each pixel, opacities of kinds times `opacity`, in the colours that a host gives where it does;
/// none where lines have one colour for all.
pub(crate) fn paint(scope: &mut Scope<'_>, flow: &FlowDog, opacity: f32, line: [f32; 4]) -> Option<ImageId> {
    let kinds = by_kind(scope, flow, opacity, line);
    match scope.input(LINE_PAINT.id) {
        Some(given) => Some(given_line_paint::pass(scope.plan, given, kinds, line)),
        None => kinds,
    }
}

/// RGB and opacity of lines at each pixel by the kind of lines that geometry draws there.
fn by_kind(scope: &mut Scope<'_>, flow: &FlowDog, opacity: f32, line: [f32; 4]) -> Option<ImageId> {
    // Not all styles draw kinds of lines in colours of their own.
    scope.spec.param(LINE_COLORS.id)?;
    if scope.option::<LineColors>(LINE_COLORS.id) == LineColors::One {
        return None;
    }
    let Guides { normal, depth, object_id } = flow_dog::guides(scope, flow.guide_weight);
    let kinds = line_kinds::pass(scope.plan, [normal, depth, object_id])?;
    let wobble = scope.spec.param(WOBBLE.id).map_or(0.0, |_| scope.float(WOBBLE.id));
    let sigma = SPREAD[0] * flow.widest() + SPREAD[1] * scope.scale() + 0.5 * wobble;
    let sigma = sigma.min(WIDEST);
    let around = gaussian_blur::pass(scope.plan, kinds, sigma, Class::Field);
    let [crease, outline, border] = [CREASE_COLOR, OUTLINE_COLOR, BORDER_COLOR].map(|param| {
        let [r, g, b, a] = scope.color(param.id);
        [r, g, b, a * opacity]
    });
    // Of narrow windows, all that there is.
    let inverse_peak = (sigma / PEAK).max(1.0);
    let colours = Colours { line, crease, outline, border, inverse_peak, padding: Default::default() };
    Some(line_paint::pass(scope.plan, around, &colours))
}

/// The edges along a tensor field, whose ends run out into points.
pub(crate) fn tapered(
    scope: &mut Scope<'_>,
    flow: &FlowDog,
    edges: ImageId,
    tensor: impl FnOnce(&mut Scope<'_>) -> ImageId,
) -> ImageId {
    let sigma = scope.float(TAPER.id);
    if sigma <= 0.0 {
        return edges;
    }
    let (tensor, color) = (tensor(scope), scope.required("color"));
    let black = Composite { line: [0.0, 0.0, 0.0, 1.0], paper: [1.0; 4] };
    let drawn = composite_lines::pass(scope.plan, color, edges, &black);
    let half = (HALF_LINE * flow.widest()).clamp(1.0, WIDEST);
    let soft = gaussian_blur::pass(scope.plan, drawn, half, Class::Colour);
    let darkest = disc_extremum::pass(scope.plan, soft, 1.5 * half, Extremum::Least);
    let field = orientation_field::pass(scope.plan, tensor);
    line_taper::pass(scope.plan, &Lines { edges, soft, darkest, field }, sigma)
}

/// The edges, of which those of things behind others end where the gap before the outlines of these begins.
pub(crate) fn gapped(scope: &mut Scope<'_>, flow: &FlowDog, edges: ImageId) -> ImageId {
    let gap = scope.float(LINE_GAP.id);
    let Some(depth) = scope.input(flow_dog::DEPTH.id).filter(|_| gap > 0.0) else { return edges };
    let outline = HALF_OUTLINE[0] * flow.outline() + HALF_OUTLINE[1] * scope.scale();
    let outline = (outline - occluders::BAND).clamp(1.0, WIDEST);
    let occluders = occluders::pass(scope.plan, depth);
    let [beside, around] = [outline, outline + gap]
        .map(|radius| disc_extremum::pass(scope.plan, occluders, radius, Extremum::Greatest));
    let kept = line_gap::pass(scope.plan, [depth, beside, around]);
    let kept = gaussian_blur::pass(scope.plan, kept, SOFT_ENDS, Class::Field);
    line_fade::pass(scope.plan, edges, kept)
}
