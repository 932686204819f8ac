//! The pictures that may enter a graph beside the colour.

use std::ffi::CStr;

use super::catalogue::Kind;
use super::error::{Error, Result, check};
use super::library::{Library, status_name};
use super::text;
use isophote_abi::IsophoteGuidesApi;
use serde::Serialize;

/// Name of the extension.
const EXTENSION: &CStr = c"isophote.guides/1";

/// A picture that may enter a graph.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Guide {
    /// Name of the graph's input, such as `normal`.
    pub id: &'static str,
    /// For people.
    pub label: &'static str,
    /// One sentence.
    pub doc: &'static str,
    /// Kind of the picture.
    pub kind: Kind,
    /// Values a pixel.
    pub channels: u32,
    /// Bit in the guides of a request.
    pub bit: u32,
}

impl Library {
    /// All guides, in the library's order.
    ///
    /// # Errors
    /// [`Error`](crate::Error) when the library has no list of them.
    pub fn guides(&self) -> Result<Vec<Guide>> {
        let table = self.extension::<IsophoteGuidesApi>(EXTENSION, "this library has no list of guides")?;
        let (mut guides, mut count) = (std::ptr::null(), 0);
        // SAFETY: both places may be written during the call.
        let status = unsafe { (table.guides)(&raw mut guides, &raw mut count) };
        check(status, || format!("the guides: {}", status_name(self.api, status)))?;
        // SAFETY: the library's list and its texts live as long as it is loaded, which is until the process ends.
        let guides = unsafe { text::slice(guides, count) };
        let guide = |guide: &isophote_abi::IsophoteGuide| {
            // SAFETY: as above.
            let [id, label, doc] =
                [guide.id, guide.label, guide.doc].map(|text| unsafe { text::constant(text) });
            Guide { id, label, doc, kind: Kind::new(guide.kind), channels: guide.channels, bit: guide.bit }
        };
        Ok(guides.iter().map(guide).collect())
    }

    /// The bits of the guides of these names in a request. The colour, which is always there, has none.
    ///
    /// # Errors
    /// [`Error`](crate::Error) for a name that no guide bears, and as [`Library::guides`].
    pub fn guide_bits<'n>(&self, names: impl IntoIterator<Item = &'n str>) -> Result<u32> {
        let guides = self.guides()?;
        let mut bits = 0;
        for name in names.into_iter().filter(|name| *name != "color") {
            let found = guides.iter().find(|guide| guide.id == name);
            bits |= found.map(|guide| guide.bit).ok_or_else(|| Error::Call {
                status: isophote_abi::ISOPHOTE_ERROR_UNKNOWN,
                message: format!(
                    "'{name}' is no guide; the guides are {}",
                    guides.iter().map(|guide| guide.id).collect::<Vec<_>>().join(", ")
                ),
            })?;
        }
        Ok(bits)
    }
}
