//! The library, once it is loaded.

use crate::exception::usage;
use isophote_loader::Library;
use pyo3::exceptions::PyImportError;
use pyo3::prelude::*;
use std::path::Path;
use std::sync::OnceLock;

static LIBRARY: OnceLock<Library> = OnceLock::new();

/// Loads the file that the environment variable `ISOPHOTE_LIBRARY` names, or this one, unless a library is loaded.
///
/// # Errors
/// `ImportError` with the reason.
pub fn load(path: &Path) -> PyResult<()> {
    if LIBRARY.get().is_none() {
        let is_named = std::env::var_os("ISOPHOTE_LIBRARY").is_some_and(|name| !name.is_empty());
        let opened = if is_named { Library::open() } else { Library::from_file(path) };
        let opened = opened.map_err(|e| PyImportError::new_err(e.to_string()))?;
        // Another thread may just have loaded the same.
        let _ = LIBRARY.set(opened);
    }
    Ok(())
}

/// The library.
///
/// # Errors
/// When none is loaded, which cannot be once the package is imported.
pub fn library() -> PyResult<&'static Library> {
    LIBRARY.get().ok_or_else(|| usage("the library is not loaded; import isophote"))
}
