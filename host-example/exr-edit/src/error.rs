//! Reasons why a file is refused.

/// Problem with a file. Problems are phrases that follow the name of the file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The file is not what it says.
    #[error("is damaged: {0}")]
    Damaged(String),
    /// The file is of a kind that is not read or cannot be written again.
    #[error("{problem}; {remedy}")]
    Unsupported {
        /// The fact that is refused.
        problem: String,
        /// Advice to put it right.
        remedy: String,
    },
    /// Reading or writing would take more than [`Limits::memory`](crate::Limits::memory).
    #[error("needs {needed} bytes of memory more; {left} of {limit} are left")]
    Memory {
        /// Bytes that were asked for.
        needed: u64,
        /// Bytes that are not in use.
        left: u64,
        /// The limit.
        limit: u64,
    },
    /// The caller's planes do not fit the file, or a name cannot be that of a channel.
    #[error("cannot be changed so: {0}")]
    Argument(String),
    /// The result could not be written.
    #[error("cannot be written: {0}")]
    Write(#[from] std::io::Error),
}

impl Error {
    pub(crate) fn damaged(problem: impl Into<String>) -> Self {
        Self::Damaged(problem.into())
    }

    pub(crate) fn unsupported(problem: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self::Unsupported { problem: problem.into(), remedy: remedy.into() }
    }

    /// The error of bytes that end too early.
    pub(crate) fn ends() -> Self {
        Self::damaged("it ends before the picture does")
    }
}

/// The result of everything in this crate.
pub type Result<T> = std::result::Result<T, Error>;
