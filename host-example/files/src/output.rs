//! Messages on standard output and standard error.

use std::fmt::Display;
use std::io::{ErrorKind, Write};
use std::sync::{Mutex, MutexGuard, PoisonError};

use isophote_loader::printable;

use crate::error::{Error, Result};

/// Prints to standard output what terminals can take; whoever has read enough and closed it is no error.
///
/// # Errors
/// [`Error::Failure`] when it cannot be written.
pub fn print(text: &str) -> Result<()> {
    let mut stdout = std::io::stdout().lock();
    printed(stdout.write_all(printable(text).as_bytes()).and_then(|()| stdout.flush()))
}

/// The result of printing to standard output, which whoever has read enough may have closed.
///
/// # Errors
/// As [`print()`].
pub fn printed(result: std::io::Result<()>) -> Result<()> {
    match result {
        Err(e) if e.kind() != ErrorKind::BrokenPipe => {
            Err(Error::failure(format!("cannot write to standard output: {e}"), "redirect it elsewhere"))
        }
        _ => Ok(()),
    }
}

/// Warnings that are kept instead of being printed, while somebody wants them.
static KEPT: Mutex<Option<Vec<String>>> = Mutex::new(None);

fn kept() -> MutexGuard<'static, Option<Vec<String>>> {
    KEPT.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The result of some work, with its warnings, which are not printed.
pub fn with_warnings<T>(work: impl FnOnce() -> T) -> (T, Vec<String>) {
    *kept() = Some(Vec::new());
    let result = work();
    (result, kept().take().unwrap_or_default())
}

/// Prints a warning on a line of standard error.
pub fn warn(warning: impl Display) {
    if let Some(kept) = kept().as_mut() {
        kept.push(warning.to_string());
        return;
    }
    // Where nobody can be warned the work goes on.
    let _ = writeln!(std::io::stderr(), "warning: {}", printable(&warning.to_string()));
}

/// Prints an error on standard error.
pub fn complain(error: &Error) {
    // As for warnings; the exit code tells, too.
    let _ = writeln!(std::io::stderr(), "error: {error}");
}
