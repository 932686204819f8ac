//! The looks that ship: presets tuned by eye, each named for what it looks like.
//!
//! They are the files of the folder `looks` of this crate, built in. `look:ID` takes the place of a style or a preset
//! anywhere.

use super::fault::Fault;
use super::file::Preset;
use crate::error::nearest_name;

/// Beginning of the names of looks; no node has such an id.
pub const PREFIX: &str = "look:";

/// A look.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Look {
    /// The stem of its file, which never changes.
    pub id: &'static str,
    /// Its file: the text of a preset.
    pub json: &'static str,
}

/// Makes looks of the ids in `looks/order.txt`.
macro_rules! looks {
    ($($id:ident)+) => {
        &[$(Look {
            id: stringify!($id),
            json: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/looks/", stringify!($id), ".json")),
        },)+]
    };
}

/// All looks in the order of lists, those of one style together.
pub const LOOKS: &[Look] = include!("../../looks/order.txt");

impl Look {
    /// Its name in the place of a style.
    pub fn name(&self) -> String {
        format!("{PREFIX}{}", self.id)
    }

    /// The preset that it is.
    ///
    /// # Errors
    /// The fault of a file that is none, which tests keep out of the crate.
    pub fn preset(&self) -> Result<Preset, Fault> {
        Preset::parse(&self.name(), self.json)
    }
}

/// The id where a style is named as a look, known or not.
pub fn id_of_look(name: &str) -> Option<&str> {
    name.strip_prefix(PREFIX)
}

/// The look of this id.
///
/// # Errors
/// The fault of an id that no look has; it names the nearest.
pub fn look(id: &str) -> Result<Look, Fault> {
    if let Some(look) = LOOKS.iter().find(|look| look.id == id) {
        return Ok(*look);
    }
    // Names are told by their ids: blanks and capitals are no reason to miss one.
    let wanted = id.to_lowercase().replace([' ', '-'], "_");
    let near = nearest_name(&wanted, LOOKS.iter().map(|look| look.id)).filter(|_| !wanted.is_empty());
    let fix = near.map_or_else(
        || "choose from the list of looks".to_owned(),
        |near| format!("did you mean '{PREFIX}{near}'?"),
    );
    Err(Fault::unknown(format!("{PREFIX}{id}"), "is no look", fix))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn every_file_is_listed() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("looks");
        let entries = std::fs::read_dir(folder).expect("the folder is there");
        let mut files: Vec<String> =
            entries.map(|e| e.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
        files.retain(|file| file != "order.txt");
        files.sort();
        let mut known: Vec<String> = LOOKS.iter().map(|look| format!("{}.json", look.id)).collect();
        known.sort();
        assert_eq!(files, known);
    }

    #[test]
    fn files_are_as_they_are_written() {
        for look in LOOKS {
            assert_eq!(look.json, look.preset().expect("it can be read").to_json(), "{}", look.id);
        }
    }

    #[test]
    fn an_unknown_look_names_the_nearest() {
        for (wanted, fix) in [
            ("coperplate", "did you mean 'look:copperplate'?"),
            ("Saturday comic", "did you mean 'look:saturday_comic'?"),
            ("zzzzzzzzzzzzzzzzzzzzzzzz", "the list of looks"),
            ("", "the list of looks"),
        ] {
            let message = look(wanted).expect_err("there is no such look").to_string();
            assert!(message.contains(wanted) && message.contains(fix), "{message}");
        }
        assert_eq!(id_of_look("look:copperplate"), Some("copperplate"));
        assert_eq!(id_of_look("copperplate"), None);
    }
}
