//! Ben-Day dots: flat colours printed as comics were.

use crate::declare::spec::{Param, Scope};
use crate::kernels::colour::benday_dots::{self, Dots};
use crate::stages::LOOK;
use crate::stages::lines::{SHOW, Show};
use isophote_engine::ImageId;

pub(crate) const DOTS: Param = Param::float("dots", "Ben-Day dots", 0.0, [0.0, 1.0])
    .structural()
    .group(LOOK)
    .hint("Prints light and mid colours as dots of ink on white paper, as in old comics; 0 prints none and costs nothing.")
    .doc(
        "Seen from afar the dots have the colours of the picture; darks and pure colours are solid. Lines are not \
         printed, and neither is the picture where they are shown alone.",
    );
pub(crate) const DOT_SPACING: Param = Param::length("dot_spacing", "Dot spacing", 9.0, [2.0, 256.0])
    .slider(3.0, 40.0)
    .group(LOOK)
    .hint("Distance from one Ben-Day dot to the next.")
    .doc("Where the rendered size leaves it less than two pixels, dots fade to flat tones.");

/// A drawing with its areas printed as `dots` says: no pass where that is 0. Lines, where `edges` is 0, stay.
pub(crate) fn printed(scope: &mut Scope<'_>, drawn: ImageId, edges: ImageId, opacity: f32) -> ImageId {
    let amount = scope.float(DOTS.id);
    if amount <= 0.0 || scope.option::<Show>(SHOW.id) == Show::Lines {
        return drawn;
    }
    let spacing = scope.float(DOT_SPACING.id);
    let dots = Dots { spacing, amount, opacity, origin: scope.origin() };
    benday_dots::pass(scope.plan, drawn, edges, &dots)
}
