//! The looks that ship with the program: presets tuned by eye, each named for what it looks like.
//!
//! They are the files of the folder `looks`, built into the program. `look:ID` takes the place of a style or a preset
//! anywhere; a file of that name is still reached as `./look:ID`.

use std::path::Path;

use crate::stylize::preset::Preset;
use isophote_files::error::{Error, Result};

/// What the names of looks start with; no node has such an id.
const PREFIX: &str = "look:";

/// Ids and files, in the order in which they are listed: that of `looks/order.rs`, whose lines group looks of one kind.
const FILES: &[(&str, &str)] = &include!(concat!(env!("OUT_DIR"), "/looks.rs"));

/// A look.
#[derive(Clone, Debug, PartialEq)]
pub struct Look {
    /// The stem of its file, which never changes.
    pub id: &'static str,
    /// Its name, tags, description, style and parameters.
    pub preset: Preset,
}

impl Look {
    /// What takes the place of a style.
    pub fn style(&self) -> String {
        named(self.id)
    }
}

/// All looks, those of one style together.
///
/// # Errors
/// [`Error::Input`] for what is no preset, which tests keep out of the program.
pub fn all() -> Result<Vec<Look>> {
    FILES.iter().map(|(id, text)| Ok(Look { id, preset: preset(id, text)? })).collect()
}

/// The look of this id.
///
/// # Errors
/// [`Error::Input`] where there is none, naming the nearest.
pub fn find(id: &str) -> Result<Look> {
    let (id, text) = file(id)?;
    Ok(Look { id, preset: preset(id, text)? })
}

/// The id where a style or preset is named as a look, whether it is known or not.
pub fn id(style: &Path) -> Option<&str> {
    style.to_str()?.strip_prefix(PREFIX)
}

/// The file of the look of this id, as text.
///
/// # Errors
/// As [`find`].
pub fn text(id: &str) -> Result<&'static str> {
    file(id).map(|(_, text)| text)
}

/// What takes the place of a style, where someone wrote the id alone.
pub fn meant(id: &str) -> Option<String> {
    FILES.iter().any(|(known, _)| *known == id).then(|| named(id))
}

fn named(id: &str) -> String {
    format!("{PREFIX}{id}")
}

fn preset(id: &str, text: &str) -> Result<Preset> {
    Preset::parse(Path::new(&named(id)), text)
}

fn file(id: &str) -> Result<(&'static str, &'static str)> {
    if let Some((id, text)) = FILES.iter().find(|(known, _)| *known == id) {
        return Ok((id, text));
    }
    // Names are told by their ids: blanks and capitals are no reason to miss one.
    let wanted = id.to_lowercase().replace([' ', '-'], "_");
    let near = FILES
        .iter()
        .map(|(known, _)| (strsim::damerau_levenshtein(&wanted, known), known))
        .filter(|(distance, known)| *distance <= known.len() / 2)
        .min();
    let fix = near.map_or_else(
        || "`isophote preset list` lists them".to_owned(),
        |(_, known)| format!("did you mean '{}'?", named(known)),
    );
    Err(Error::input(named(id), "is no look", fix))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_file_is_built_in() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../nodes/library/looks");
        let entries = std::fs::read_dir(folder).expect("the folder is there");
        let mut files: Vec<String> =
            entries.map(|e| e.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
        files.retain(|file| file != "order.rs");
        files.sort();
        let mut known: Vec<String> = FILES.iter().map(|(id, _)| format!("{id}.json")).collect();
        known.sort();
        assert_eq!(files, known);
    }

    #[test]
    fn files_are_as_they_are_written() {
        for look in all().expect("all can be read") {
            let (_, text) = file(look.id).expect("it is known");
            assert_eq!(text, look.preset.to_json(), "{}", look.id);
        }
    }

    #[test]
    fn names_of_looks_are_told_from_files_and_nodes() {
        assert_eq!(id(Path::new("look:copperplate")), Some("copperplate"));
        for other in ["copperplate", "./look:copperplate", "looks/look:copperplate", "ink", "look.json"] {
            assert_eq!(id(Path::new(other)), None, "{other}");
        }
        assert_eq!(meant("copperplate").as_deref(), Some("look:copperplate"));
        assert_eq!(meant("ink"), None);
    }

    #[test]
    fn an_unknown_look_names_the_nearest() {
        for (wanted, fix) in [
            ("coperplate", "did you mean 'look:copperplate'?"),
            ("Saturday comic", "did you mean 'look:saturday_comic'?"),
            ("zzzzzzzzzzzzzzzzzzzzzzzz", "`isophote preset list`"),
        ] {
            let message = find(wanted).expect_err("there is no such look").to_string();
            assert!(message.contains(wanted) && message.contains(fix), "{message}");
        }
    }
}
