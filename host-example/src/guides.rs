//! The renderer's targets as a plan names them: the colour, and the guides that go with it.

use isophote_loader::Library;
use isophote_loader::abi::{
    ISOPHOTE_GUIDE_CONTROL, ISOPHOTE_GUIDE_DEPTH, ISOPHOTE_GUIDE_MOTION, ISOPHOTE_GUIDE_NORMAL,
    ISOPHOTE_GUIDE_OBJECT_ID, ISOPHOTE_GUIDE_REST_POSITION, ISOPHOTE_SPACE_LINEAR, IsophoteRequest,
};
use isophote_render::targets::{Target, Targets};

/// All that the renderer knows about a pixel of any scene beside its colour.
const GUIDES: u32 = ISOPHOTE_GUIDE_NORMAL
    | ISOPHOTE_GUIDE_DEPTH
    | ISOPHOTE_GUIDE_OBJECT_ID
    | ISOPHOTE_GUIDE_MOTION
    | ISOPHOTE_GUIDE_REST_POSITION;

/// Bits of all that the renderer knows about a pixel of these targets beside its colour: few scenes have a control map.
pub fn known(targets: &Targets) -> u32 {
    GUIDES | if targets.control.is_some() { ISOPHOTE_GUIDE_CONTROL } else { 0 }
}

/// The request for a frame of the renderer: linear light, premultiplied, with the guides of every scene. Lengths of a style are pixels of
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
pub fn inputs<'t>(color: &'t Target, targets: &'t Targets) -> Vec<(&'static str, &'t wgpu::TextureView)> {
    // Where no plan reads rest positions, nobody has asked for them, and anything may stand for them.
    let rest = targets.rest.as_ref().unwrap_or(&targets.normal);
    let mut inputs = vec![
        ("color", &color.view),
        ("normal", &targets.normal.view),
        ("depth", &targets.depth.view),
        ("object_id", &targets.object_id.view),
        ("motion", &targets.motion.view),
        ("rest_position", &rest.view),
    ];
    inputs.extend(targets.control.iter().map(|control| ("control", &control.view)));
    inputs
}
