//! The extension "isophote.guides/1": the pictures that may enter a graph, as a list.

use super::constants::{IsophoteKind, IsophoteStatus};
use core::ffi::c_char;

/// A picture that may enter a graph.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct IsophoteGuide {
    /// Name of the graph's input, such as "normal".
    pub id: *const c_char,
    /// For people.
    pub label: *const c_char,
    /// One sentence.
    pub doc: *const c_char,
    /// Kind of the picture.
    pub kind: IsophoteKind,
    /// Values a pixel.
    pub channels: u32,
    /// Bit in `IsophoteRequest::guides`.
    pub bit: u32,
}

/// The functions of the extension "isophote.guides/1". Tags and ownership are those of `IsophoteApi`.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct IsophoteGuidesApi {
    /// Size of this table in bytes.
    pub struct_size: u32,

    /// [any-thread] All pictures that may enter a graph beside the colour.
    pub guides: unsafe extern "C" fn(guides: *mut *const IsophoteGuide, count: *mut u32) -> IsophoteStatus,
}
