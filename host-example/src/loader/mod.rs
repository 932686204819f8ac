//! The dynamic library: finding it, opening it, and safe types over its table of functions.
//!
//! This is the whole of what a viewer needs to use Isophote, and the only place of the host with `unsafe`.
//! The declarations are the library's own ([`contract`]); handles become types that destroy what they hold,
//! statuses become [`Refusal`]s, pointers become slices and text.

#![allow(unsafe_code, reason = "foreign functions are called here and nowhere else in the host")]

pub mod catalogue;
#[path = "../../../include/rust/mod.rs"]
pub mod contract;
pub mod device;
pub mod graph;
mod open;
pub mod plan;
pub mod process;
mod text;

pub use catalogue::Catalogue;
pub use device::Device;
pub use graph::Graph;
pub use plan::Plan;
pub use process::{Control, Input, Report};

use std::path::{Path, PathBuf};

use self::contract::{
    ISOPHOTE_CANCELLED, ISOPHOTE_DEVICE, ISOPHOTE_INTERNAL, ISOPHOTE_INVALID_HANDLE, ISOPHOTE_NO_DEVICE,
    ISOPHOTE_OK, ISOPHOTE_OUT_OF_MEMORY, IsophoteApi, IsophoteRequest, IsophoteStatus,
};
use crate::error::{Error, Result};

/// The library, open until the process ends.
#[derive(Clone, Debug)]
pub struct Library {
    api: &'static IsophoteApi,
    path: PathBuf,
}

impl Library {
    /// Finds and opens the library: the file that the environment variable `ISOPHOTE_LIBRARY` names;
    /// otherwise the first of the executable's own folder, `lib` beside that folder, and where the system
    /// looks.
    ///
    /// # Errors
    /// [`Error::Failure`] when it is missing, is not a dynamic library, is not Isophote, or is of another ABI
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
    /// [`Refusal`] for impossible sizes.
    pub fn request(&self, size: (u32, u32)) -> Answer<IsophoteRequest> {
        let mut request = IsophoteRequest { width: 0, height: 0, scale: 0.0, space: 0, alpha: 0, guides: 0 };
        // SAFETY: `request` may be written during the call.
        let status = unsafe { (self.api.request_init)(size.0, size.1, &raw mut request) };
        check(status, || format!("{}x{} pixels: {}", size.0, size.1, status_name(self.api, status)))?;
        Ok(request)
    }
}

/// What the library says when it does not do what was asked.
#[derive(Clone, Debug)]
pub struct Refusal {
    /// The status, never `ISOPHOTE_OK`.
    pub status: IsophoteStatus,
    /// The library's own message.
    pub message: String,
}

/// Result of a call of the library.
pub type Answer<T> = std::result::Result<T, Refusal>;

impl Refusal {
    /// As the host's error. Devices, memory and mistakes of the library are failures; everything else is the
    /// fault of the input at `place`, which `mend` puts right.
    pub fn at(self, place: impl std::fmt::Display, mend: impl std::fmt::Display) -> Error {
        match self.status {
            ISOPHOTE_NO_DEVICE => Error::failure(
                self.message,
                "use --backend cpu, or install a graphics driver; a software one will do (on Debian: apt install \
                 mesa-vulkan-drivers libvulkan1)",
            ),
            ISOPHOTE_DEVICE | ISOPHOTE_OUT_OF_MEMORY => {
                Error::failure(self.message, "use a smaller picture or --backend cpu")
            }
            ISOPHOTE_CANCELLED => Error::failure(self.message, "start again"),
            ISOPHOTE_INVALID_HANDLE | ISOPHOTE_INTERNAL => {
                Error::failure(self.message, "this is a mistake in the program; please report it")
            }
            _ => Error::input(place, self.message, mend),
        }
    }
}

/// An error unless the status is success; `message` fetches what the library said.
fn check(status: IsophoteStatus, message: impl FnOnce() -> String) -> Answer<()> {
    if status == ISOPHOTE_OK { Ok(()) } else { Err(Refusal { status, message: message() }) }
}

fn status_name(api: &IsophoteApi, status: IsophoteStatus) -> &'static str {
    // SAFETY: takes any number; the name lives as long as the library, which is never unloaded.
    unsafe { text::constant((api.status_name)(status)) }
}
