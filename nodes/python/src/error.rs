//! Why the library cannot be loaded.

use std::fmt::Display;

/// Why the library cannot be loaded.
#[derive(Debug)]
pub struct Error {
    problem: String,
    fix: String,
}

impl Error {
    /// What is wrong, and how to put it right.
    pub fn failure(problem: impl Display, fix: impl Display) -> Self {
        Self { problem: problem.to_string(), fix: fix.to_string() }
    }
}

impl Display for Error {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}; {}", self.problem, self.fix)
    }
}

/// Result of loading the library.
pub type Result<T> = std::result::Result<T, Error>;
