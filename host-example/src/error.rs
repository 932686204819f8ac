//! The host's one error type: every failure is a single line that says what is wrong, where, and how to
//! fix it, and knows the exit code that goes with it.

use std::fmt::Display;
use std::path::Path;

/// Why a command could not be carried out.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The input or the way the program was called is at fault (exit code 2).
    #[error("{place}: {problem}; {fix}")]
    Input {
        /// The file, option or value at fault.
        place: String,
        /// What is wrong with it.
        problem: String,
        /// How to put it right.
        fix: String,
    },
    /// The machine or a device could not do its part (exit code 1).
    #[error("{problem}; {fix}")]
    Failure {
        /// What went wrong.
        problem: String,
        /// How to put it right.
        fix: String,
    },
}

impl Error {
    /// An [`Error::Input`] about a file.
    pub fn file(path: &Path, problem: impl Display, fix: impl Display) -> Self {
        Self::input(path.display(), problem, fix)
    }

    /// An [`Error::Input`] about a picture that its decoder refuses.
    pub fn malformed(path: &Path, kind: &str, problem: impl Display) -> Self {
        Self::file(path, format!("is damaged and cannot be read as {kind}: {problem}"), "use an intact file")
    }

    /// An [`Error::Input`] about anything that has a name.
    pub fn input(place: impl Display, problem: impl Display, fix: impl Display) -> Self {
        Self::Input { place: one_line(place), problem: one_line(problem), fix: one_line(fix) }
    }

    /// An [`Error::Failure`].
    pub fn failure(problem: impl Display, fix: impl Display) -> Self {
        Self::Failure { problem: one_line(problem), fix: one_line(fix) }
    }

    /// The same of a file that names the place at fault.
    #[must_use]
    pub fn within(self, path: &Path) -> Self {
        match self {
            Self::Input { place, problem, fix } => {
                Self::Input { place: format!("{}: {place}", path.display()), problem, fix }
            }
            Self::Failure { problem, fix } => {
                Self::Failure { problem: format!("{}: {problem}", path.display()), fix }
            }
        }
    }

    /// The process exit code: 2 for bad usage or input, 1 for everything else.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Input { .. } => 2,
            Self::Failure { .. } => 1,
        }
    }
}

/// Messages of other libraries may span lines; ours never do.
fn one_line(text: impl Display) -> String {
    text.to_string().split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Result of everything in the host.
pub type Result<T> = std::result::Result<T, Error>;
