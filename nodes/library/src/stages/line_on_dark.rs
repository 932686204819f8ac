//! Lines on dark ground: light, where a dark line could not be seen.

use crate::declare::choice::choice;
use crate::declare::spec::{Param, Scope};
use crate::kernels::colour::light_on_dark::{self, Params};
use crate::kernels::colour::light_paint;
use crate::kernels::lines::lightness_moments;
use crate::stages::line_context::surroundings;
use isophote_engine::ImageId;

const ID: &str = "line_on_dark";
const LABEL: &str = "Lines on dark";

pub(crate) const LINE_ON_DARK: Param = Param::choice(ID, LABEL, OnDark::Off.selected())
    .hint("Turns lines light where the picture is darker than they are seen on, as in a black car or coat.")
    .doc(
        "The mean lightness around a line decides, in a window of about 12 pixels: 25 units of L above the line's \
         own where normals, depth or object ids are known, 14 where they are not. Lines that are light or of a strong colour stay.",
    );

/// The same for drawings, whose masses can open instead.
pub(crate) const MASSES_ON_DARK: Param = Param::choice(ID, LABEL, MassesOnDark::Off.selected())
    .hint("Lets lines be seen in dark masses: cut out of them, or drawn over hatching that lets paper through.")
    .doc("Masses are then those of the shading alone. What is drawn in the picture's own colours has no solid masses.");

choice! {
    /// Lines where the ground is dark.
    pub(crate) enum OnDark {
        /// The colour of the lines, however dark the ground is.
        Off ("off", "As elsewhere"),
        /// A lighter tint of the ground where it is dark.
        Light ("light", "Light"),
    }
}

choice! {
    /// Lines where masses are dark.
    pub(crate) enum MassesOnDark {
        /// Dark lines, which are lost in dark masses.
        Off ("off", "As elsewhere"),
        /// Lines left bare in dark masses.
        Light ("light", "Light"),
        /// Dark lines, over masses that are hatched instead of solid.
        Open ("open", "Open masses"),
    }
}

/// Lightness that a ground has above a line that is seen on it, units of L, where guides are known: forms are what they say.
const SEEN: f32 = 25.0;
/// The same in photographs, where a line of dark skin or leaves is no outline and looks wrong in white.
const SEEN_ALONE: f32 = 14.0;
/// Units of L over which lines turn light: few, since half-way they are seen on nothing.
const TURN: f32 = 3.0;
/// Part of the way from the ground to white that light lines go.
const LIFT: f32 = 0.38;
/// Strongest channel of lines from which on they are seen on dark ground by their own light or colour, and that at which none
/// turns.
const STRONG_LINES: [f32; 2] = [0.3, 0.6];
/// Standard deviation of the window around a line, pixels of the full picture.
const WINDOW: f32 = 6.0;

/// Moments of lightness around each pixel of (L alpha, alpha).
pub(crate) fn ground(scope: &mut Scope<'_>, lightness: ImageId) -> ImageId {
    let moments = lightness_moments::pass(scope.plan, lightness);
    let sigma = WINDOW * scope.scale();
    surroundings(scope.plan, moments, sigma)
}

/// Draws the edges in a colour over `rgb`, light where its `lightness` is low; `guided` where guides are known.
pub(crate) fn drawn(
    scope: &mut Scope<'_>,
    [rgb, edges, lightness]: [ImageId; 3],
    line: [f32; 4],
    guided: bool,
) -> ImageId {
    let params = Params {
        line,
        light: [1.0, 1.0, 1.0, LIFT],
        paper: [0.0; 4],
        dark: least_ground(line, seen(guided)),
        inverse: 1.0 / TURN,
        padding: Default::default(),
    };
    let ground = ground(scope, lightness);
    light_on_dark::pass(scope.plan, [rgb, edges, ground], &params)
}

/// RGB and opacity of lines at each pixel over `rgb`, light where its `lightness` is low; `guided` where guides are known.
pub(crate) fn painted(scope: &mut Scope<'_>, [paint, rgb, lightness]: [ImageId; 3], guided: bool) -> ImageId {
    let [from, to] = STRONG_LINES;
    let params = light_paint::Params {
        seen: seen(guided),
        inverse: 1.0 / TURN,
        lift: LIFT,
        strong: to,
        inverse_range: 1.0 / (to - from),
    };
    let ground = ground(scope, lightness);
    light_paint::pass(scope.plan, [paint, rgb, ground], &params)
}

/// Lightness that a ground has above a line that is seen on it.
const fn seen(guided: bool) -> f32 {
    if guided { SEEN } else { SEEN_ALONE }
}

/// Lightness of the ground from which on a line is seen that needs `seen` units of L.
fn least_ground([r, g, b, _]: [f32; 4], seen: f32) -> f32 {
    // Greys have about as much lightness as they have of white.
    let own = 100.0 * (0.2126 * r + 0.7152 * g + 0.0722 * b);
    let [from, to] = STRONG_LINES;
    (own + seen) * ((to - r.max(g).max(b)) / (to - from)).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_and_strongly_coloured_lines_stay_as_they_are() {
        let grey = |v: f32| least_ground([v, v, v, 1.0], SEEN);
        assert_eq!(grey(0.0), SEEN);
        assert!(grey(0.1) > grey(0.0));
        assert_eq!([grey(0.6), grey(1.0), least_ground([1.0, 0.0, 1.0, 1.0], SEEN)], [0.0; 3]);
    }
}
