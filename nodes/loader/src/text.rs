//! Text across the boundary: constants of the library, messages that it writes, and arguments.

use std::ffi::{CStr, CString, c_char};

use super::error::{Error, Result};
use super::printable::printable;
use isophote_abi::{
    ISOPHOTE_ERROR_INVALID_ARGUMENT, ISOPHOTE_ERROR_TRUNCATED, ISOPHOTE_OK, IsophoteStatus, IsophoteText,
};

/// Room for a message; longer ones are cut.
const ROOM: usize = 2048;

/// Text that the library keeps for the life of the process; null is empty.
///
/// # Safety
/// `pointer` is null or points to bytes that end with a zero and stay as they are until the process ends.
pub unsafe fn constant(pointer: *const c_char) -> &'static str {
    // SAFETY: as the caller promised.
    unsafe { kept(pointer) }
}

/// Text that an object of the library keeps; null is empty.
///
/// # Safety
/// `pointer` is null or points to bytes that end with a zero and stay as they are for `'a`.
pub unsafe fn kept<'a>(pointer: *const c_char) -> &'a str {
    if pointer.is_null() {
        return "";
    }
    // SAFETY: not null, ends with a zero and stays, as the caller promised.
    unsafe { CStr::from_ptr(pointer) }.to_str().unwrap_or_default()
}

/// Text that `write` puts into the buffer that it is given, whatever it returns, made [`printable`]: messages repeat names
/// that come from files.
pub fn message<T>(write: impl FnOnce(*mut IsophoteText) -> T) -> (T, String) {
    let mut bytes = [0u8; ROOM];
    let mut text = IsophoteText { data: bytes.as_mut_ptr().cast(), capacity: ROOM, length: 0 };
    let value = write(&raw mut text);
    let length = text.length.min(ROOM - 1);
    (value, printable(&String::from_utf8_lossy(&bytes[..length])).into_owned())
}

/// A whole text of any length: asked for its length first, then for itself.
pub fn whole(mut write: impl FnMut(*mut IsophoteText) -> IsophoteStatus) -> (IsophoteStatus, String) {
    let mut bytes = Vec::new();
    loop {
        let mut text =
            IsophoteText { data: bytes.as_mut_ptr() as *mut c_char, capacity: bytes.len(), length: 0 };
        if bytes.is_empty() {
            text.data = std::ptr::null_mut();
        }
        let status = write(&raw mut text);
        let fits = text.length < bytes.len();
        if fits || !matches!(status, ISOPHOTE_OK | ISOPHOTE_ERROR_TRUNCATED) {
            bytes.truncate(if fits { text.length } else { 0 });
            return (status, String::from_utf8_lossy(&bytes).into_owned());
        }
        bytes = vec![0u8; text.length + 1];
    }
}

/// Text as an argument.
///
/// # Errors
/// [`Error`] when the text holds a zero, which would end it early.
pub fn argument(text: &str) -> Result<CString> {
    CString::new(text).map_err(|_| Error::Call {
        status: ISOPHOTE_ERROR_INVALID_ARGUMENT,
        message: format!("'{}' holds a zero character", text.replace('\0', "\\0")),
    })
}

/// An array of the library; null is empty.
///
/// # Safety
/// `pointer` is null or points to `count` values that stay as they are for `'a`.
pub unsafe fn slice<'a, T>(pointer: *const T, count: u32) -> &'a [T] {
    if pointer.is_null() || count == 0 {
        return &[];
    }
    // SAFETY: not null, and as many values as the caller promised.
    unsafe { std::slice::from_raw_parts(pointer, count as usize) }
}
