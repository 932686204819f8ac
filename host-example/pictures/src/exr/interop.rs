//! Primaries of EXR files that name their colour space instead: the attribute `colorInteropID`.
//!
//! Source: "Color Space Encodings" of the Color Interop Forum (2025), as OpenEXR 3.4 and Blender 5 write it.

use std::sync::Once;

use isophote_exr_edit::File;

use crate::primaries::{AP0, AP1, Chromaticities, P3, REC709, REC2020};
use isophote_files::output;

/// Name of the attribute.
const NAME: &str = "colorInteropID";

/// The primaries of a part: its chromaticities, or those that its colour space has; nothing for Rec.709 and for what is not
/// known, of which a warning tells.
pub fn chromaticities(exr: &File, part: usize) -> Option<Chromaticities> {
    if let Some(own) = exr.parts()[part].chromaticities {
        return Some(own);
    }
    let (_, text) = exr.texts(part).find(|(name, _)| *name == NAME)?;
    let id = String::from_utf8_lossy(text);
    let id = id.trim_end_matches('\0').trim();
    let known = of(id);
    if known.is_none() && !matches!(id, "" | "data" | "unknown") {
        static TOLD: Once = Once::new();
        TOLD.call_once(|| {
            output::warn(format_args!(
                "{NAME} {id} is not known and taken for linear Rec.709; --space says what it is"
            ));
        });
    }
    known
}

/// The primaries of linear light by this name.
fn of(id: &str) -> Option<Chromaticities> {
    match id.strip_prefix("lin_")?.strip_suffix("_scene")? {
        "rec709" => Some(REC709),
        "p3d65" => Some(P3),
        "rec2020" => Some(REC2020),
        "ap1" => Some(AP1),
        "ap0" => Some(AP0),
        "adobergb" => Some([0.64, 0.33, 0.21, 0.71, 0.15, 0.06, 0.3127, 0.3290]),
        _ => None,
    }
}
