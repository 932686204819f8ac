//! In which space a picture is filtered.

use crate::exr::Picture;
use crate::primaries::{AP1, Change, REC709, same};
use crate::read::ImageState;
use crate::space::Space;

/// The colour space in which a picture is filtered, and the change of primaries to it, which the library does not
/// know and which is done here.
pub struct WorkingSpace {
    /// The space of the request.
    pub space: Space,
    /// To Rec.709 and back, for primaries that a request cannot name.
    pub change: Option<(Change, Change)>,
}

impl WorkingSpace {
    /// Space that `space` names, or that of the file without.
    pub fn of(space: Option<Space>, state: ImageState, picture: &Picture) -> Self {
        let known = |space| Self { space, change: None };
        let primaries = match (space, state) {
            (Some(Space::P3 | Space::Rec2020), _) => space.and_then(Space::primaries),
            (Some(space), _) => return known(space),
            (None, ImageState::DisplayReferred) => return known(Space::Srgb),
            (None, ImageState::SceneReferred) => picture.chromaticities,
        };
        let change = |from| Some((Change::new(from, REC709)?, Change::new(REC709, from)?));
        match primaries {
            Some(c) if same(c, AP1) => known(Space::Acescg),
            Some(c) if !same(c, REC709) && picture.pixels.channels() > 1 => {
                Self { space: Space::Linear, change: change(c) }
            }
            _ => known(Space::Linear),
        }
    }
}
