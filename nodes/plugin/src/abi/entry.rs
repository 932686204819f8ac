//! The one symbol that the library exports.

use isophote_abi::{ISOPHOTE_ABI_VERSION, IsophoteApi};

/// [any-thread] Returns the table of ABI version `abi_version`, or null when this library has none of
/// that number. The table is the library's and valid for the life of the process.
// SAFETY: the name is claimed by nothing else, as every name that begins with `isophote_`.
#[unsafe(no_mangle)]
pub extern "C" fn isophote_api(abi_version: u32) -> *const IsophoteApi {
    crate::pinned::pin();
    crate::reserve::keep();
    if abi_version == ISOPHOTE_ABI_VERSION { &raw const super::API } else { std::ptr::null() }
}
