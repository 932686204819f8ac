//! Sources that graphs and presets are read from.

use std::path::Path;

use super::preset;
use isophote_files::error::{Error, Result};
use isophote_files::{frames, input};
use isophote_loader::Library;

/// Most bytes of a file; real ones have some thousands.
const MOST_BYTES: u64 = 16 << 20;

/// The text of a graph file, a preset or a look.
///
/// # Errors
/// [`Error::Input`] when it cannot be read or is too large for any of them, and for a look that does not ship.
pub fn read(path: &Path) -> Result<String> {
    if let Some(id) = preset::id_of_look(path) {
        let library = Library::open()?;
        if let Some(look) = library.looks()?.into_iter().find(|look| look.id == id) {
            return Ok(look.json.to_owned());
        }
        // Opened only to be told which is near.
        library
            .style(&path.to_string_lossy())
            .map_err(|e| preset::unknown(&library, e, path, preset::LIST_OF_LOOKS))?;
    }
    if frames::is_picture(path) {
        let fix = "the style comes before the picture: write one such as cartoon first";
        return Err(Error::file(path, "is no style", fix));
    }
    let fix = "name a graph file or a preset (.json), or a node";
    input::text(path, MOST_BYTES).map_err(|e| Error::file(path, format!("cannot be read: {e}"), fix))
}
