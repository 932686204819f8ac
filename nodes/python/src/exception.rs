//! The exceptions that Python sees.

use isophote_loader::Error;
use isophote_loader::abi::{ISOPHOTE_ERROR_INVALID_ARGUMENT, IsophoteStatus};
use pyo3::exceptions::{PyImportError, PyRuntimeError};
use pyo3::prelude::*;

/// The exception for an error of the library: a class of `isophote.errors`, with the library's own sentence.
pub fn raised(py: Python<'_>, error: &Error) -> PyErr {
    match error {
        Error::Call { status, message } => of_status(py, *status, message),
        Error::Fault { status, fault } => of_status(py, *status, &fault.to_string()),
        error => PyImportError::new_err(error.to_string()),
    }
}

fn of_status(py: Python<'_>, status: IsophoteStatus, message: &str) -> PyErr {
    let errors = py.import("isophote.errors");
    match errors.and_then(|errors| errors.call_method1("of_status", (status, message))) {
        Ok(exception) => PyErr::from_value(exception),
        Err(failed) => failed,
    }
}

/// The exception for a value that cannot be, as the library's own for such values.
pub fn invalid(message: String) -> PyErr {
    Python::attach(|py| of_status(py, ISOPHOTE_ERROR_INVALID_ARGUMENT, &message))
}

/// The exception for wrong use of this module.
pub fn usage(message: &str) -> PyErr {
    PyRuntimeError::new_err(message.to_owned())
}
