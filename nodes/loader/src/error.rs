//! Errors of loading the library and of its functions.

use isophote_abi::{ISOPHOTE_OK, IsophoteStatus};

/// Reason why the library did not do its work.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The library cannot be loaded.
    #[error("{problem}; {fix}")]
    Load {
        /// The problem with it, and where it was looked for.
        problem: String,
        /// Advice to put it right.
        fix: &'static str,
    },
    /// A function of the library failed.
    #[error("{message}")]
    Call {
        /// The status, never `ISOPHOTE_OK`.
        status: IsophoteStatus,
        /// The library's own message.
        message: String,
    },
}

/// Result of everything in this crate.
pub type Result<T> = std::result::Result<T, Error>;

impl Error {
    /// The status of a call that failed.
    pub const fn status(&self) -> Option<IsophoteStatus> {
        match self {
            Self::Call { status, .. } => Some(*status),
            Self::Load { .. } => None,
        }
    }
}

/// An error unless the status is success; `message` fetches what the library said.
pub(crate) fn check(status: IsophoteStatus, message: impl FnOnce() -> String) -> Result<()> {
    if status == ISOPHOTE_OK { Ok(()) } else { Err(Error::Call { status, message: message() }) }
}
