//! The renderer's targets as a plan names them: the colour, and the guides that go with it.

use isophote_loader::Library;
use isophote_loader::abi::{
    ISOPHOTE_GUIDE_ALBEDO, ISOPHOTE_GUIDE_CONTROL, ISOPHOTE_GUIDE_DEPTH, ISOPHOTE_GUIDE_DIFFUSE,
    ISOPHOTE_GUIDE_MOTION, ISOPHOTE_GUIDE_NORMAL, ISOPHOTE_GUIDE_OBJECT_ID, ISOPHOTE_GUIDE_REST_POSITION,
    ISOPHOTE_GUIDE_SPECULAR, ISOPHOTE_SPACE_LINEAR, IsophoteRequest,
};
use isophote_pictures::meaning::ImageState;
use isophote_render::targets::Targets;

/// All that the renderer knows about a pixel of any scene beside its colour.
const GUIDES: u32 = ISOPHOTE_GUIDE_NORMAL
    | ISOPHOTE_GUIDE_DEPTH
    | ISOPHOTE_GUIDE_OBJECT_ID
    | ISOPHOTE_GUIDE_MOTION
    | ISOPHOTE_GUIDE_REST_POSITION;

/// Colours of surfaces and their light.
const LIGHT: u32 = ISOPHOTE_GUIDE_ALBEDO | ISOPHOTE_GUIDE_DIFFUSE | ISOPHOTE_GUIDE_SPECULAR;

/// Bits of all that the renderer knows about a pixel of these targets beside its colour in this state: few scenes have a
/// control map, and few styles read light.
pub fn known(targets: &Targets, state: ImageState) -> u32 {
    let control = if targets.control.is_some() { ISOPHOTE_GUIDE_CONTROL } else { 0 };
    let light = if targets.layers_in(state).is_some() { LIGHT } else { 0 };
    GUIDES | control | light
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

/// The targets under the names of a plan's inputs, with the colour in this state.
pub fn inputs(targets: &Targets, state: ImageState) -> Vec<(&'static str, &wgpu::TextureView)> {
    // Where no plan reads rest positions, nobody has asked for them, and anything may stand for them.
    let rest = targets.rest.as_ref().unwrap_or(&targets.normal);
    let mut inputs = vec![
        ("color", &targets.color_in(state).view),
        ("normal", &targets.normal.view),
        ("depth", &targets.depth.view),
        ("object_id", &targets.object_id.view),
        ("motion", &targets.motion.view),
        ("rest_position", &rest.view),
    ];
    inputs.extend(targets.control.iter().map(|control| ("control", &control.view)));
    let light = targets.layers_in(state).map(|layers| layers.map(|target| &target.view));
    inputs
        .extend(light.into_iter().flat_map(|light| ["albedo", "diffuse", "specular"].into_iter().zip(light)));
    inputs
}
