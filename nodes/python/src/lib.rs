//! `isophote._native`: the dynamic library's table as Python objects.
//!
//! The package beside this file (`isophote/`) is what people use. It prepares arrays, styles and settings; here
//! they meet the library, which comes in the same wheel and is loaded as any other host in Rust does it, by
//! `isophote-loader`. So there is one implementation of everything that images go through, and results are those of the C face.
//!
//! Work is done without the interpreter's lock. An object that another thread works with is waited for without it, too.

#![allow(unsafe_code, reason = "arrays of NumPy and the functions of the library's table meet here")]

pub mod array;
pub mod colour;
pub mod exception;
pub mod motion;
pub mod objects;
pub mod opened;
pub mod owned;
pub mod watch;

use crate::exception::{invalid, raised, usage};
use crate::opened::library;
use isophote_loader::StyleText;
use isophote_loader::abi::ISOPHOTE_REFERENCE_HEIGHT;
use pyo3::prelude::*;
use std::path::PathBuf;

/// The extension module.
#[pymodule(name = "_native", gil_used = true)]
pub mod native {
    use super::*;

    #[pymodule_export]
    use crate::colour::{change_space, color_space};
    #[pymodule_export]
    use crate::motion::motion;
    #[pymodule_export]
    use crate::objects::{Device, Graph, Request, Sequence, Style};

    /// Lines of the picture that relative lengths are meant for.
    #[pymodule_export]
    const REFERENCE_HEIGHT: u32 = ISOPHOTE_REFERENCE_HEIGHT;

    /// Loads the library: the file that the environment variable ISOPHOTE_LIBRARY names, or this one.
    #[pyfunction]
    fn load(path: PathBuf) -> PyResult<()> {
        opened::load(&path)
    }

    /// Version of the library, such as "0.1.0".
    #[pyfunction]
    fn version() -> PyResult<&'static str> {
        Ok(library()?.version())
    }

    /// The file that the library was loaded from.
    #[pyfunction]
    fn library_path() -> PyResult<PathBuf> {
        Ok(library()?.path().to_owned())
    }

    /// All nodes, as JSON.
    #[pyfunction]
    fn catalogue(py: Python<'_>) -> PyResult<String> {
        let catalogue = library()?.catalogue().map_err(|error| raised(py, &error))?;
        serde_json::to_string(&catalogue).map_err(|e| usage(&format!("the catalogue: {e}")))
    }

    /// The pictures that may enter a graph beside the colour, as JSON.
    #[pyfunction]
    fn guides(py: Python<'_>) -> PyResult<String> {
        let guides = library()?.guides().map_err(|error| raised(py, &error))?;
        serde_json::to_string(&guides).map_err(|e| usage(&format!("the guides: {e}")))
    }

    /// The looks that ship: their ids with the texts of their presets, in their order.
    #[pyfunction]
    fn looks(py: Python<'_>) -> PyResult<Vec<(&'static str, &'static str)>> {
        let looks = library()?.looks().map_err(|error| raised(py, &error))?;
        Ok(looks.into_iter().map(|look| (look.id, look.json)).collect())
    }

    /// Content of the text of a preset, as JSON of one form; none for the text of a graph. `place` names it in messages.
    #[pyfunction]
    fn read_preset(py: Python<'_>, place: &str, json: &str) -> PyResult<Option<String>> {
        let read = library()?.read_style(place, json).map_err(|error| raised(py, &error))?;
        let StyleText::Preset(preset, faults) = read else { return Ok(None) };
        match faults.first() {
            Some(fault) => Err(invalid(fault.to_string())),
            None => serde_json::to_string(&preset).map(Some).map_err(|e| usage(&format!("the preset: {e}"))),
        }
    }

    /// Ends worker threads that are idle and gives back memory kept for later calls.
    #[pyfunction]
    fn trim(py: Python<'_>) -> PyResult<()> {
        let library = library()?;
        py.detach(|| library.trim()).map_err(|error| raised(py, &error))
    }
}
