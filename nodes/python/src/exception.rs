//! The exceptions that Python sees.

use crate::loader::Refusal;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

/// The exception for what the library refuses: a class of `isophote.errors`, with the library's own sentence.
pub fn raised(py: Python<'_>, refusal: &Refusal) -> PyErr {
    let made = py
        .import("isophote.errors")
        .and_then(|errors| errors.call_method1("of_status", (refusal.status, refusal.message.as_str())));
    match made {
        Ok(exception) => PyErr::from_value(exception),
        Err(failed) => failed,
    }
}

/// The exception for wrong use of this module.
pub fn usage(message: &str) -> PyErr {
    PyRuntimeError::new_err(message.to_owned())
}
