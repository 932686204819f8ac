//! Parameters of styles that direct places of a picture by a map which is found in it.

use crate::declare::param::Param;

/// Strength of the map that is found. Without it the map takes no part in a plan.
pub(crate) const IMPORTANCE: Param = Param::float("importance", "Importance", 0.0, [0.0, 1.0])
    .structural()
    .group("look")
    .hint("Keeps detail where shapes are clear and sharp, and calms textures, blur and what is far from the middle.")
    .doc(
        "Strength of a control map that is found in the picture (see the node `importance`), with factors of 1/4 to 2 on \
         detail; lines become fewer where detail does. What an artist painted in `control` adds to it.",
    );

pub(crate) const CENTRE: Param = Param::float("importance_centre", "Towards the middle", 0.5, [0.0, 1.0])
    .group("advanced")
    .hint("How much less things count that are far from the middle of the picture.")
    .doc("Share by which a Gaussian weighs what is found; its standard deviation is 0.3 of the diagonal.");
