//! The renderer's targets as a plan names them: the colour, and the guides that go with it.

use isophote_loader::Library;
use isophote_loader::abi::{
    ISOPHOTE_GUIDE_DEPTH, ISOPHOTE_GUIDE_MOTION, ISOPHOTE_GUIDE_NORMAL, ISOPHOTE_GUIDE_OBJECT_ID,
    ISOPHOTE_GUIDE_REST_POSITION, ISOPHOTE_SPACE_LINEAR, IsophoteRequest,
};
use isophote_render::targets::{Target, Targets};

/// All that the renderer knows about a pixel beside its colour.
const GUIDES: u32 = ISOPHOTE_GUIDE_NORMAL
    | ISOPHOTE_GUIDE_DEPTH
    | ISOPHOTE_GUIDE_OBJECT_ID
    | ISOPHOTE_GUIDE_MOTION
    | ISOPHOTE_GUIDE_REST_POSITION;

/// The request for a frame of the renderer: linear light, premultiplied, with all guides. Lengths of a style are pixels of
/// a picture of `reference_height` lines, or of the frame itself where that is 0.
///
/// # Errors
/// [`isophote_loader::Error`] for impossible sizes.
pub fn request(
    library: &Library,
    size: (u32, u32),
    reference_height: u32,
) -> isophote_loader::Result<IsophoteRequest> {
    let request = library.request(size)?;
    Ok(IsophoteRequest { space: ISOPHOTE_SPACE_LINEAR, guides: GUIDES, reference_height, ..request })
}

/// The targets under the names of a plan's inputs; `color` is one of the two that hold colour.
pub fn inputs<'t>(color: &'t Target, targets: &'t Targets) -> [(&'static str, &'t wgpu::TextureView); 6] {
    // Where no plan reads rest positions, nobody has asked for them, and anything may stand for them.
    let rest = targets.rest.as_ref().unwrap_or(&targets.normal);
    [
        ("color", &color.view),
        ("normal", &targets.normal.view),
        ("depth", &targets.depth.view),
        ("object_id", &targets.object_id.view),
        ("motion", &targets.motion.view),
        ("rest_position", &rest.view),
    ]
}
