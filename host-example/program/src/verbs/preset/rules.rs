//! What a preset that is saved names: files from its new place, and things of its rules one by one.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;

use isophote_files::error::{Error, Result};
use isophote_finishing::stylize::preset::{self, ObjectRule};
use isophote_finishing::stylize::source;
use isophote_pictures::exr::{MaskSource, WholeNames};
use isophote_pictures::read::{Any, Unread};

/// Keys of a rule for its things and for the look that they have.
const MATCH: &str = "match";
const LOOK: &str = "look";

/// Lets rules of a preset in the file `base` that is saved to `file` name their looks' files from there.
///
/// # Errors
/// As [`from`].
pub fn move_looks(rules: &mut [ObjectRule], base: &Path, file: &Path) -> Result<()> {
    for look in rules.iter_mut().filter_map(|rule| rule.rule.get_mut(LOOK)) {
        if let Some(beside) = beside(look, base) {
            *look = from(file, Path::new(&beside))?.into();
        }
    }
    Ok(())
}

/// The path of a file as a preset names it: relative where both lie in one folder, whole otherwise.
///
/// # Errors
/// [`Error::Input`] for paths that are no text, which JSON cannot hold.
pub fn from(preset: &Path, named: &Path) -> Result<String> {
    let folder = |path: &Path| {
        let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        fs::canonicalize(folder).ok()
    };
    let path = match (folder(preset), folder(named), named.file_name()) {
        (Some(a), Some(b), Some(name)) if a == b => PathBuf::from(name),
        (_, Some(folder), Some(name)) => folder.join(name),
        _ => named.to_owned(),
    };
    let text = path.into_os_string().into_string();
    text.map_err(|_| Error::file(named, "has a name that is no UTF-8, which no preset can hold", "rename it"))
}

/// The file of a look, where a rule of the preset `base` names one.
fn beside(look: &Value, base: &Path) -> Option<std::ffi::OsString> {
    let name = look.as_str()?;
    let beside = preset::style_beside(name, base);
    (beside != *name).then_some(beside)
}

/// Writes rules of a preset in the file `base` out for hosts that know things by whole names alone: names with stars by the Cryptomatte
/// of `frame`, and looks in files.
///
/// # Errors
/// As [`preset::things`] and [`WholeNames::words`]; [`Error::Input`] for a frame that is no EXR file and for looks that are no presets.
pub fn write_out(rules: &mut [ObjectRule], base: &Path, frame: &Path) -> Result<()> {
    let place = base.display().to_string();
    let things: Vec<MaskSource> = preset::things(&place, rules).collect::<Result<_>>()?;
    let unread = Unread::open(frame)?;
    let Any::Exr(bytes) = unread.any(frame)? else {
        return Err(Error::file(frame, "is no EXR file, and has no Cryptomatte", "name a frame of the shot"));
    };
    let names = WholeNames::of(frame, bytes)?;
    for (rule, things) in rules.iter_mut().zip(things) {
        let words = names.words(&things, &rule.things)?;
        rule.rule.insert(MATCH.into(), words.clone().into());
        rule.things = words;
        if let Some(look) = rule.rule.get_mut(LOOK)
            && let Some(beside) = beside(look, base)
        {
            let path = Path::new(&beside);
            let text = source::read(path)?;
            *look = serde_json::from_str(&text)
                .map_err(|error| Error::malformed(path, "preset", error.to_string()))?;
        }
    }
    Ok(())
}
