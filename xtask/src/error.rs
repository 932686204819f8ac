//! Error of a chore: one line with what, where and why.

use std::fmt;

/// A failure, as the line that the user reads.
#[derive(Debug)]
pub struct Failure(pub String);

impl fmt::Display for Failure {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.0)
    }
}

/// The result of a chore.
pub type Result<T> = std::result::Result<T, Failure>;

/// Description of the work that an error from below has ended.
pub trait Context<T> {
    /// Puts a description in front of the error.
    ///
    /// # Errors
    /// The error it was called on.
    fn context(self, what: impl FnOnce() -> String) -> Result<T>;
}

impl<T, E: fmt::Display> Context<T> for std::result::Result<T, E> {
    fn context(self, what: impl FnOnce() -> String) -> Result<T> {
        self.map_err(|error| Failure(format!("{}: {error}", what())))
    }
}
