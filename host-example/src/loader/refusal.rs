//! What the library refuses, and why.

use super::contract::{
    ISOPHOTE_ERROR_CANCELLED, ISOPHOTE_ERROR_DEVICE, ISOPHOTE_ERROR_INTERNAL, ISOPHOTE_ERROR_INVALID_HANDLE,
    ISOPHOTE_ERROR_NO_DEVICE, ISOPHOTE_ERROR_OUT_OF_MEMORY, ISOPHOTE_OK, IsophoteStatus,
};
use crate::error::Error;

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

impl Refusal {
    /// As the host's error. Devices, memory and mistakes of the library are failures; everything else is the
    /// fault of the input at `place`, which `fix` puts right.
    pub fn at(self, place: impl std::fmt::Display, fix: impl std::fmt::Display) -> Error {
        match self.status {
            ISOPHOTE_ERROR_NO_DEVICE => Error::failure(
                self.message,
                "use --backend cpu, or install a graphics driver; a software one will do (on Debian: apt install \
                 mesa-vulkan-drivers libvulkan1)",
            ),
            ISOPHOTE_ERROR_DEVICE | ISOPHOTE_ERROR_OUT_OF_MEMORY => {
                Error::failure(self.message, "use a smaller picture or --backend cpu")
            }
            ISOPHOTE_ERROR_CANCELLED => Error::failure(self.message, "start again"),
            ISOPHOTE_ERROR_INVALID_HANDLE | ISOPHOTE_ERROR_INTERNAL => {
                Error::failure(self.message, "this is a mistake in the program; please report it")
            }
            _ => Error::input(place, self.message, fix),
        }
    }
}

/// An error unless the status is success; `message` fetches what the library said.
pub(super) fn check(status: IsophoteStatus, message: impl FnOnce() -> String) -> Answer<()> {
    if status == ISOPHOTE_OK { Ok(()) } else { Err(Refusal { status, message: message() }) }
}
