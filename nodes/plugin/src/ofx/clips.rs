//! Names of the clips.

use super::host::Host;
use super::image::Clip;
use isophote::graph::GraphInput;
use isophote_abi::openfx::Handle;
use std::ffi::CStr;

/// The picture.
pub const SOURCE: &CStr = c"Source";
/// The result.
pub const OUTPUT: &CStr = c"Output";
/// Name of the clip that says where the effect shows.
pub const MASK: &CStr = c"Mask";
/// Vectors to the frame before.
pub const MOTION: &CStr = c"Motion";
/// Vectors to the frame after.
pub const MOTION_FORWARD: &CStr = c"MotionForward";

/// The guides that may be clips, in the order of inputs.
pub const GUIDES: [GraphInput; 5] = [
    GraphInput::Normal,
    GraphInput::Depth,
    GraphInput::Motion,
    GraphInput::MotionForward,
    GraphInput::RestPosition,
];

/// Name of the clip that gives a guide.
pub fn guide_clip(guide: GraphInput) -> Option<&'static CStr> {
    match guide {
        GraphInput::Normal => Some(c"Normal"),
        GraphInput::Depth => Some(c"Depth"),
        GraphInput::Motion => Some(MOTION),
        GraphInput::MotionForward => Some(MOTION_FORWARD),
        GraphInput::RestPosition => Some(c"RestPosition"),
        _ => None,
    }
}

/// Label for people of the clip that gives a guide, where it is not its name.
pub fn guide_label(guide: GraphInput) -> Option<&'static CStr> {
    match guide {
        GraphInput::MotionForward => Some(c"Motion forward"),
        GraphInput::RestPosition => Some(c"Rest position"),
        other => guide_clip(other),
    }
}

/// True where the instance has a clip of this name, and the host does not say that it is open.
pub fn is_connected(host: &Host, instance: Handle, name: &CStr) -> bool {
    Clip::of(host, instance, name).is_some_and(|clip| !clip.is_open())
}
