//! Parameters of Kuwahara filters by sectors (§ 5.3).

use crate::declare::spec::{Param, Scope};

/// N.
pub(crate) const SECTORS: Param = Param::int("sectors", "Sectors", 8, [4, 8])
    .hint("Directions in which patches are compared: 8 follow corners and curves better than 4.")
    .doc("Sectors of the disc (N), 4 or 8; more than 4 are 8.");

/// q.
pub(crate) const Q: Param = Param::float("q", "Edge sharpness", 8.0, [1.0, 64.0])
    .slider(1.0, 16.0)
    .hint("How crisp the borders between patches are.")
    .doc("Exponent by which flat sectors outweigh others (q of 5.15): higher is sharper.");

/// tau_s.
pub(crate) const THRESHOLD: Param = Param::float("threshold", "Flat below", 0.0627, [0.001, 1.0])
    .slider(0.005, 0.3)
    .hint("Differences below this count as flat, so that faint noise is painted over.")
    .doc("Standard deviation below which sectors count as flat (tau_s of 5.15), RGB in 0..1.");

/// The chosen number of sectors.
pub(crate) fn sectors(scope: &Scope<'_>) -> u32 {
    if scope.int("sectors") > 4 { 8 } else { 4 }
}
