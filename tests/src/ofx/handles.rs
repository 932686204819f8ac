//! Addresses and texts as they pass between a host and its plugins.

use isophote_abi::openfx::Handle;
use std::collections::HashMap;
use std::ffi::{CStr, CString, c_char, c_void};
use std::ptr::null_mut;

/// Texts by name.
pub(super) type Named<T> = HashMap<CString, T>;

/// The address as a handle.
pub(super) fn handle_of<T>(thing: &T) -> Handle {
    std::ptr::from_ref(thing).cast_mut().cast::<c_void>()
}

/// A copy of foreign text.
///
/// # Safety
/// `text` is null or leads to a string with a closing zero.
pub(super) unsafe fn owned(text: *const c_char) -> Option<CString> {
    // SAFETY: as the caller promised.
    (!text.is_null()).then(|| unsafe { CStr::from_ptr(text) }.to_owned())
}

/// Nothing, for a place that a plugin asked to be filled.
pub(super) fn nothing(place: *mut Handle) {
    if !place.is_null() {
        // SAFETY: the plugin gave a place for a handle.
        unsafe { place.write(null_mut()) };
    }
}
