//! `isophote._native`: the dynamic library's table as Python objects.
//!
//! The package beside this file (`isophote/`) is what people use. It prepares arrays, styles and settings; here
//! they meet the library, which comes in the same wheel and is loaded as any other host in Rust does it, by
//! `isophote-loader`. So there is one implementation of everything that images go through, and results are those of the C face.
//!
//! Work is done without the interpreter's lock. An object that another thread works with is waited for without it, too.

#![allow(unsafe_code, reason = "arrays of NumPy and the functions of the library's table meet here")]

pub mod array;
pub mod exception;
pub mod motion;
pub mod objects;
pub mod opened;
pub mod owned;
pub mod watch;

use crate::exception::{raised, usage};
use crate::opened::library;
use pyo3::prelude::*;
use std::path::PathBuf;

/// The extension module.
#[pymodule(name = "_native", gil_used = true)]
pub mod native {
    use super::*;

    #[pymodule_export]
    use crate::motion::motion;
    #[pymodule_export]
    use crate::objects::{Device, Graph, Request, Sequence};

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

    /// Ends worker threads that are idle and gives back memory kept for later calls.
    #[pyfunction]
    fn trim(py: Python<'_>) -> PyResult<()> {
        let library = library()?;
        py.detach(|| library.trim()).map_err(|error| raised(py, &error))
    }
}
