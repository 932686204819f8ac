//! Parameters of nodes that know of time.

use crate::declare::param::Param;

/// `hold` of nodes that draw by noise.
pub(crate) const HOLD: Param = Param::int("hold", "Hold", 0, [0, 1000])
    .slider(0.0, 24.0)
    .group("time")
    .hint("Frames that grain and strokes last: 1 draws them anew in each frame, 0 keeps them for ever.");

/// True for a parameter that decides whether frames of one and the same picture differ ([`Graph::is_animated`]).
///
/// [`Graph::is_animated`]: crate::Graph::is_animated
pub fn animates_marks(param: &Param) -> bool {
    [HOLD.id, STEADINESS.id, RENEWAL.id].contains(&param.id)
}

/// `steadiness` of nodes that carry what they have found from frame to frame.
pub(crate) const STEADINESS: Param = Param::float("steadiness", "Steadiness", 0.0, [0.0, 1.0])
    .structural()
    .group("time")
    .hint("How calm moving pictures are: neighbouring frames are averaged along the motion. 0 is off, 0.5 suits most shots.").doc(
        "How much neighbouring frames count, carried here along the motion of things: 0 leaves each frame alone, 0.5 is \
         for sequences, 1 lets all frames of the window count alike.",
    );

/// `window` of the same nodes.
pub(crate) const WINDOW: Param = Param::int("window", "Frames around", 2, [0, 8])
    .structural()
    .group("time")
    .hint("Neighbouring frames that count, to each side.")
    .doc("They count as far as they and the motion from them are known.");

/// `renewal` of nodes whose marks motion carries.
pub(crate) const RENEWAL: Param = Param::int("renewal", "Mark lifetime", 8, [0, 16])
    .structural()
    .group("time")
    .hint("Frames for which marks travel with the motion before they are drawn anew; 0 leaves them on the screen.").doc(
        "Frames for which motion carries marks where `steadiness` is above 0 and no rest positions are known, before they \
         begin anew; two layers take turns. A frame depends on the motion of as many frames before it, less two. 0 or 1 \
         leaves marks on the screen.",
    );
