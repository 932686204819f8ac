//! The opened library: its version and its requests.

use std::path::{Path, PathBuf};

use super::contract::{IsophoteApi, IsophoteRequest, IsophoteStatus};
use super::refusal::{Answer, check};
use super::{open, text};
use crate::error::Result;

// SAFETY: the table and its texts are constant for as long as the library is open, which is never closed; its
// functions may be called on any thread, with a handle on one at a time, which the types that own handles see to.
unsafe impl Sync for IsophoteApi {}

/// The library, open until the process ends.
#[derive(Clone, Debug)]
pub struct Library {
    pub(super) api: &'static IsophoteApi,
    path: PathBuf,
}

impl Library {
    /// Finds and opens the library: the file that the environment variable `ISOPHOTE_LIBRARY` names;
    /// otherwise the first of the executable's own folder, `lib` beside that folder, and where the system
    /// looks.
    ///
    /// # Errors
    /// [`crate::error::Error::Failure`] when it is missing, is not a dynamic library, is not Isophote, or is of another ABI
    /// version.
    pub fn open() -> Result<Self> {
        let (api, path) = open::find()?;
        Ok(Self { api, path })
    }

    /// Opens the library from this file.
    ///
    /// # Errors
    /// As [`Library::open`].
    pub fn from_file(path: &Path) -> Result<Self> {
        Ok(Self { api: open::open(path)?, path: path.to_owned() })
    }

    /// The file that was opened.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Version of the library, such as `0.1.0`.
    pub fn version(&self) -> &'static str {
        // SAFETY: the table's strings live as long as the library, which is never unloaded.
        unsafe { text::constant(self.api.version) }
    }

    /// A request for a whole picture: full scale, sRGB, premultiplied alpha, no guides.
    ///
    /// # Errors
    /// [`Refusal`](super::refusal::Refusal) for impossible sizes.
    pub fn request(&self, size: (u32, u32)) -> Answer<IsophoteRequest> {
        let mut request = IsophoteRequest {
            width: 0,
            height: 0,
            scale: 0.0,
            space: 0,
            alpha: 0,
            guides: 0,
            origin_x: 0.0,
            origin_y: 0.0,
            frame: 0,
            reference_height: 0,
            canonical_height: 0,
        };
        // SAFETY: `request` may be written during the call.
        let status = unsafe { (self.api.request_init)(size.0, size.1, &raw mut request) };
        check(status, || format!("{}x{} pixels: {}", size.0, size.1, status_name(self.api, status)))?;
        Ok(request)
    }
}

/// The library's name of a status.
pub(super) fn status_name(api: &IsophoteApi, status: IsophoteStatus) -> &'static str {
    // SAFETY: takes any number; the name lives as long as the library, which is never unloaded.
    unsafe { text::constant((api.status_name)(status)) }
}
