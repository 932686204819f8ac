//! Errors of loading the library and of its functions.

use std::fmt::{Display, Formatter};

use isophote_abi::{ISOPHOTE_OK, IsophoteStatus};
use serde::Deserialize;

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
    /// A preset, a look or a value is at fault.
    #[error("{fault}")]
    Fault {
        /// The status, never `ISOPHOTE_OK`.
        status: IsophoteStatus,
        /// Its parts.
        fault: Fault,
    },
}

/// Fault of a preset: where it is, what is wrong, and how to mend it.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
pub struct Fault {
    /// File and parameter at fault; empty where the caller knows them alone.
    pub place: String,
    /// Problem with it.
    pub problem: String,
    /// Way to put it right; empty where the problem says that.
    pub fix: String,
    /// Id of the node whose declaration says what is possible; empty for none.
    pub node: String,
}

impl Display for Fault {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        if !self.place.is_empty() {
            write!(f, "{}: ", self.place)?;
        }
        f.write_str(&self.problem)?;
        if self.fix.is_empty() { Ok(()) } else { write!(f, "; {}", self.fix) }
    }
}

/// Result of everything in this crate.
pub type Result<T> = std::result::Result<T, Error>;

impl Error {
    /// The status of a call that failed.
    pub const fn status(&self) -> Option<IsophoteStatus> {
        match self {
            Self::Call { status, .. } | Self::Fault { status, .. } => Some(*status),
            Self::Load { .. } => None,
        }
    }
}

/// An error unless the status is success; `message` fetches what the library said.
pub(crate) fn check(status: IsophoteStatus, message: impl FnOnce() -> String) -> Result<()> {
    if status == ISOPHOTE_OK { Ok(()) } else { Err(Error::Call { status, message: message() }) }
}
