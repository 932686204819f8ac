//! Meaning of the numbers of an EXR file: its chromaticities and windows, and the attribute `colorInteropID`, by which files
//! name their colour space.
//!
//! Source: "Color Space Encodings" of the Color Interop Forum (2025), as OpenEXR 3.4 and Blender 5 write it.

use isophote_exr_edit::File;

use crate::meaning::{Alpha, Meaning};
use crate::primaries::{ADOBE, AP0, AP1, Change, Chromaticities, P3, REC709, REC2020, same};
use crate::transfer::Transfer;

/// Name of the attribute.
const NAME: &str = "colorInteropID";

/// Meaning of a part's numbers. Its chromaticities go before those of the space that it names; what is not understood counts
/// as linear Rec.709, of which a warning tells.
pub fn of(exr: &File, part: usize, has_alpha: bool) -> Meaning {
    let mut meaning = Meaning::light();
    if !has_alpha {
        meaning.alpha = Alpha::None;
    }
    let own = &exr.parts()[part];
    meaning.data = Some(own.window);
    meaning.display = own.display;
    meaning.pixel_aspect = own.pixel_aspect.unwrap_or(1.0);
    let text = exr.texts(part).find(|(name, _)| *name == NAME).map(|(_, text)| String::from_utf8_lossy(text));
    let id = text.as_deref().unwrap_or_default().trim_end_matches('\0').trim();
    let named = space(id);
    if let Some((primaries, transfer)) = &named {
        meaning.primaries = *primaries;
        meaning.transfer = transfer.clone();
        meaning.said_by = Some(NAME);
    } else if !matches!(id, "" | "data" | "unknown") {
        meaning.warnings.push(format!("{NAME} {id} is not known and left aside; --space says what it is"));
    }
    let Some(written) = own.chromaticities else { return meaning };
    if Change::new(written, REC709).is_none() {
        let problem = "its chromaticities span no colours and are left aside; --space says what they are";
        meaning.warnings.push(problem.to_owned());
        return meaning;
    }
    if named.is_some_and(|(primaries, _)| !same(primaries, written)) {
        meaning.warnings.push(format!("its chromaticities are not those of {NAME} {id}, and are used"));
    }
    Meaning { primaries: written, said_by: Some("chromaticities"), ..meaning }
}

/// Primaries and transfer of the space of this name.
fn space(id: &str) -> Option<(Chromaticities, Transfer)> {
    let (transfer, rest) = id.split_once('_')?;
    let (primaries, _) = rest.rsplit_once('_').filter(|(_, state)| matches!(*state, "scene" | "display"))?;
    let primaries = match primaries {
        "rec709" => REC709,
        "p3d65" => P3,
        "rec2020" => REC2020,
        "ap1" => AP1,
        "ap0" => AP0,
        "adobergb" => ADOBE,
        _ => return None,
    };
    let transfer = match transfer {
        "lin" => Transfer::Linear,
        "srgb" | "srgbe" => Transfer::Srgb,
        "g18" => Transfer::Gamma(1.8),
        "g22" => Transfer::Gamma(2.2),
        "g24" => Transfer::Gamma(2.4),
        "g26" => Transfer::Gamma(2.6),
        "pq" => Transfer::Pq,
        "hlg" => Transfer::Hlg,
        _ => return None,
    };
    Some((primaries, transfer))
}
