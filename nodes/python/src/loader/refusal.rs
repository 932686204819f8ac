//! What the library refuses, and why.

use super::contract::{ISOPHOTE_OK, IsophoteStatus};

/// What the library says when it does not do what was asked.
#[derive(Clone, Debug)]
pub struct Refusal {
    /// The status, never `ISOPHOTE_OK`.
    pub status: IsophoteStatus,
    /// The library's own message.
    pub message: String,
}

/// Result of a call of the library.
pub type Answer<T> = Result<T, Refusal>;

/// An error unless the status is success; `message` fetches what the library said.
pub(super) fn check(status: IsophoteStatus, message: impl FnOnce() -> String) -> Answer<()> {
    if status == ISOPHOTE_OK { Ok(()) } else { Err(Refusal { status, message: message() }) }
}
