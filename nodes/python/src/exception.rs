//! The exceptions that Python sees.

use crate::loader::Refusal;
use crate::loader::contract::ISOPHOTE_ERROR_INVALID_ARGUMENT;
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

/// The exception for a value that cannot be, as the library's own for such values.
pub fn invalid(message: String) -> PyErr {
    Python::attach(|py| raised(py, &Refusal { status: ISOPHOTE_ERROR_INVALID_ARGUMENT, message }))
}

/// The exception for wrong use of this module.
pub fn usage(message: &str) -> PyErr {
    PyRuntimeError::new_err(message.to_owned())
}
