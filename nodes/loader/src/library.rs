//! The opened library: its version and its requests.

use std::ffi::CStr;
use std::path::{Path, PathBuf};

use super::error::{Error, Result, check};
use super::{open, text};
use isophote_abi::{
    ISOPHOTE_ERROR_UNSUPPORTED, IsophoteApi, IsophoteGuidesApi, IsophoteMemoryApi, IsophotePixelAspectApi,
    IsophotePrecisionApi, IsophotePresetsApi, IsophoteRequest, IsophoteSequenceApi, IsophoteStatus,
};

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
    /// [`Error::Load`](crate::Error::Load) when it is missing, is not a dynamic library, is not Isophote, or is of another ABI
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

    /// Ends worker threads that are idle and gives back memory kept for later calls.
    ///
    /// # Errors
    /// [`Error`](crate::Error) when the library fails.
    pub fn trim(&self) -> Result<()> {
        // SAFETY: takes nothing, and may be called at any time.
        let status = unsafe { (self.api.trim)() };
        check(status, || status_name(self.api, status).to_owned())
    }

    pub(super) fn extension<T: Table>(&self, id: &CStr, missing: &str) -> Result<&'static T> {
        extension(self.api, id, missing)
    }

    /// A request for a whole picture: full scale, sRGB, premultiplied alpha, no guides.
    ///
    /// # Errors
    /// [`Error`](crate::Error) for impossible sizes.
    pub fn request(&self, size: (u32, u32)) -> Result<IsophoteRequest> {
        let mut request = IsophoteRequest::default();
        // SAFETY: `request` may be written during the call.
        let status = unsafe { (self.api.request_init)(size.0, size.1, &raw mut request) };
        check(status, || format!("{}x{} pixels: {}", size.0, size.1, status_name(self.api, status)))?;
        Ok(request)
    }
}

/// The table of an extension; `missing` says what cannot be done without it.
///
/// # Errors
/// [`Error`](crate::Error) when the library has none, or a smaller one.
pub(super) fn extension<T: Table>(api: &'static IsophoteApi, id: &CStr, missing: &str) -> Result<&'static T> {
    // SAFETY: the name ends with a zero.
    let table = unsafe { (api.extension)(id.as_ptr()) }.cast::<T>();
    // SAFETY: the extensions of these names have these structs, constant as long as the library is loaded, which is until
    // the process ends; each begins with its size, which is read first.
    let table = unsafe {
        let is_whole = !table.is_null() && table.cast::<u32>().read() as usize >= size_of::<T>();
        is_whole.then(|| &*table)
    };
    table.ok_or_else(|| Error::Call { status: ISOPHOTE_ERROR_UNSUPPORTED, message: missing.to_owned() })
}

/// A table of functions that begins with its size in bytes.
pub(super) trait Table: 'static {}

impl Table for IsophoteGuidesApi {}
impl Table for IsophoteMemoryApi {}
impl Table for IsophotePixelAspectApi {}
impl Table for IsophotePrecisionApi {}
impl Table for IsophotePresetsApi {}
impl Table for IsophoteSequenceApi {}

/// The library's name of a status.
pub(super) fn status_name(api: &IsophoteApi, status: IsophoteStatus) -> &'static str {
    // SAFETY: takes any number; the name lives as long as the library, which is never unloaded.
    unsafe { text::constant((api.status_name)(status)) }
}
