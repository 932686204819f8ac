//! Lines that waver as if a hand had drawn them, and that are drawn anew every few frames as in animation by hand, where
//! they are said to boil.
//!
//! The lines alone move, after all that decides what is a line: areas of colour and paper stay, as where a painter fills
//! what an inker has drawn. What is averaged over frames is averaged before, so that a wobble that stays is no flicker.

use crate::declare::ports;
use crate::declare::spec::{self, Param, Port, Scope};
use crate::kernels::lines::line_wobble::{self, Params};
use crate::kernels::structure::smooth_noise::Layer;
use crate::stages::{LOOK, marks};
use isophote_engine::ImageId;

pub(crate) const WOBBLE: Param = Param::length("wobble", "Wobble", 0.0, [0.0, 6.0])
    .slider(0.0, 3.0)
    .structural()
    .group(LOOK)
    .hint("How far lines waver, as if a hand had drawn them; 0 for not at all.")
    .doc(
        "On each axis; what is between lines stays. They waver in waves of about 70 pixels of a picture 1080 lines high, and in \
         longer ones where they waver by more than 4, so that none folds. The waves belong to things where rest positions \
         are known, else to the screen.",
    );
pub(crate) const HOLD: Param = spec::HOLD
    .hint("Frames that wavering lines last: 2 draws them anew on twos, as in animation by hand, 0 keeps them for ever.")
    .doc("Lines waver where `wobble` is above 0.");

/// Where the wobble is anchored that belongs to things.
pub(crate) const REST_POSITION: Port = Port {
    doc: "Points of the undeformed objects, in any unit and 32 bits a channel: the wobble of lines moves with things. It is \
          read where `wobble` is above 0.",
    ..ports::REST_POSITION
};

/// Noise of one axis, by cells per pixel of the full-size picture: slow waves, and on them quicker ones.
const LAYERS: [Layer; 2] = [(1.0 / 28.0, 0.75, 0), (1.0 / 10.0, 0.25, 97)];

/// Cells of slow waves over the wobble, at the least: neighbouring points of a line keep their order.
const LEAST_CELL: f32 = 6.5;

/// Standard deviations of the noise that are the whole wobble: most lines come that far somewhere.
const SPREAD: f32 = 2.0;

/// Seeds of the noise along x and along y, more cells apart than there are in a picture.
const SEEDS: [u32; 2] = [3001, 70_001];

/// Edges (1 = paper, 0 = line) that waver as the parameters say.
pub(crate) fn wavering(scope: &mut Scope<'_>, edges: ImageId) -> ImageId {
    let amount = scope.float(WOBBLE.id);
    if amount <= 0.0 {
        return edges;
    }
    // A ratio of two lengths has no unit: the scale of the rendering is taken out again.
    let finer = (scope.scale() / (LEAST_CELL * LAYERS[0].0 * amount)).min(1.0);
    let noise = SEEDS.map(|seed| {
        let seed = scope.renewed(seed);
        let layers = LAYERS.map(|(frequency, share, n)| (finer * frequency, share, seed.wrapping_add(n)));
        marks::waves(scope, layers)
    });
    let gain = amount / (SPREAD * marks::deviation(LAYERS));
    line_wobble::pass(scope.plan, edges, noise, &Params { amount, gain })
}
