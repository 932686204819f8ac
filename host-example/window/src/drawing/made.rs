//! Origins of a picture on the device, by which the stage sees that it is still true.

use crate::state::session::Which;
use crate::state::viewport::Overlay;
use isophote_loader::abi::IsophoteRequest;
use isophote_render::lighting::Lighting as Light;
use isophote_scene::camera::View;

/// Origins of a picture. While they stay the same, so does the picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Made {
    /// Looks on both sides of the wipe.
    pub shown: [Which; 2],
    /// Look or picture over it.
    pub overlay: Overlay,
    /// Request to the library.
    pub request: IsophoteRequest,
    /// True where its looks were computed on the CPU, which counts their revisions by itself.
    pub is_on_cpu: bool,
    /// Revisions of the three looks.
    pub revisions: [u64; 3],
    /// Revision of the source.
    pub source: u64,
    /// View, lighting and time of a scene.
    pub scene: Option<(View, Light, f32)>,
}

/// State that a frame of a scene shows, looks apart.
pub type FrameState = (IsophoteRequest, u64, Option<(View, Light, f32)>);
