//! Opening and closing with a disc (§ 5.1).

use crate::kernels::smoothing::disc_extremum::{self, Extremum};
use isophote_engine::{ImageId, PlanBuilder};

/// Light features smaller than the disc go.
pub(crate) fn open(plan: &mut PlanBuilder, color: ImageId, radius: f32) -> ImageId {
    let eroded = disc_extremum::pass(plan, color, radius, Extremum::Least);
    disc_extremum::pass(plan, eroded, radius, Extremum::Greatest)
}

/// Dark features smaller than the disc go.
pub(crate) fn close(plan: &mut PlanBuilder, color: ImageId, radius: f32) -> ImageId {
    let dilated = disc_extremum::pass(plan, color, radius, Extremum::Greatest);
    disc_extremum::pass(plan, dilated, radius, Extremum::Least)
}
