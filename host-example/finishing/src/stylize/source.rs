//! Sources that graphs and presets are read from.

use std::path::Path;

use crate::stylize::looks;
use isophote_files::error::{Error, Result};
use isophote_files::input;

/// Most bytes of a file; real ones have some thousands.
const MOST_BYTES: u64 = 16 << 20;

/// The text of a graph file, a preset or a look.
///
/// # Errors
/// [`Error::Input`] when it cannot be read or is too large for any of them.
pub fn read(path: &Path) -> Result<String> {
    if let Some(id) = looks::id(path) {
        return looks::text(id).map(str::to_owned);
    }
    let fix = "name a graph file or a preset (.json), or a node";
    input::text(path, MOST_BYTES).map_err(|e| Error::file(path, format!("cannot be read: {e}"), fix))
}
