//! Buffer views that are compressed by EXT_meshopt_compression and KHR_meshopt_compression. Both have one format,
//! which is decoded here as it is specified: `meshopt` compiles C++, and `meshopt-rs` does not know version 1.

mod attributes;
mod filters;
mod indices;

use std::collections::HashMap;

use gltf::buffer::{Buffer, View};
use serde::Deserialize;
use serde_json::Value;

use crate::budget::Budget;

/// The extensions, the one to be preferred first.
const EXTENSIONS: [&str; 2] = ["KHR_meshopt_compression", "EXT_meshopt_compression"];

/// Compression of one view.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Compressed {
    buffer: usize,
    #[serde(default)]
    byte_offset: usize,
    byte_length: usize,
    byte_stride: usize,
    count: usize,
    mode: Mode,
    #[serde(default)]
    filter: Filter,
}

#[derive(Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "UPPERCASE")]
enum Mode {
    Attributes,
    Triangles,
    Indices,
}

#[derive(Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "UPPERCASE")]
enum Filter {
    #[default]
    None,
    Octahedral,
    Quaternion,
    Exponential,
    Color,
}

/// Decodes all compressed views of a document; yields their bytes by the index of the view.
///
/// # Errors
/// A clause naming the view and what is wrong with it.
pub fn decode(
    document: &gltf::Document,
    buffers: &[Vec<u8>],
    budget: &Budget,
) -> Result<HashMap<usize, Vec<u8>>, String> {
    let mut decoded = HashMap::new();
    for view in document.views() {
        let Some(value) = extension(&view) else { continue };
        let bytes = Compressed::deserialize(value)
            .map_err(|e| e.to_string())
            .and_then(|compressed| compressed.decode(view.length(), buffers, budget))
            .map_err(|problem| format!("meshopt compression of buffer view {}: {problem}", view.index()))?;
        decoded.insert(view.index(), bytes);
    }
    Ok(decoded)
}

/// True for a buffer that holds nothing but the place of what is compressed elsewhere, and need not be there.
pub fn is_placeholder(buffer: &Buffer, document: &gltf::Document) -> bool {
    let marked = |name: &str| buffer.extension_value(name).is_some_and(|value| value["fallback"] == true);
    if EXTENSIONS.into_iter().any(marked) {
        return true;
    }
    let uri = matches!(buffer.source(), gltf::buffer::Source::Uri(_));
    let mut views = document.views().filter(|view| view.buffer().index() == buffer.index()).peekable();
    let source = |view: View| extension(&view).is_some_and(|value| value["buffer"] == buffer.index());
    !uri && views.peek().is_some()
        && views.all(|view| extension(&view).is_some())
        && !document.views().any(source)
}

fn extension<'a>(view: &'a View) -> Option<&'a Value> {
    EXTENSIONS.into_iter().find_map(|name| view.extension_value(name))
}

impl Compressed {
    fn decode(&self, length: usize, buffers: &[Vec<u8>], budget: &Budget) -> Result<Vec<u8>, String> {
        let (count, stride) = (self.count, self.byte_stride);
        if !self.is_valid() || count.checked_mul(stride) != Some(length) {
            return Err(format!("{count} elements of {stride} bytes are not what it can hold"));
        }
        let end = self.byte_offset.checked_add(self.byte_length);
        let data = end.and_then(|end| buffers.get(self.buffer)?.get(self.byte_offset..end));
        let data = data.ok_or("its bytes reach beyond the end of its buffer")?;
        budget.take(count, stride)?;
        let decoded = match self.mode {
            Mode::Attributes => attributes::decode(data, count, stride),
            Mode::Triangles => indices::triangles(data, count, stride),
            Mode::Indices => indices::sequence(data, count, stride),
        };
        let mut decoded = decoded.ok_or("its bytes are damaged")?;
        match self.filter {
            Filter::None => {}
            Filter::Octahedral if stride == 4 => filters::octahedral_8(&mut decoded),
            Filter::Octahedral => filters::octahedral_16(&mut decoded),
            Filter::Quaternion => filters::quaternion(&mut decoded),
            Filter::Exponential => filters::exponential(&mut decoded),
            Filter::Color if stride == 4 => filters::color_8(&mut decoded),
            Filter::Color => filters::color_16(&mut decoded),
        }
        Ok(decoded)
    }

    /// True where the stride and the count suit the mode and the filter.
    fn is_valid(&self) -> bool {
        let stride = self.byte_stride;
        let mode = match self.mode {
            Mode::Attributes => (4..=256).contains(&stride) && stride.is_multiple_of(4),
            Mode::Triangles => matches!(stride, 2 | 4) && self.count.is_multiple_of(3),
            Mode::Indices => matches!(stride, 2 | 4),
        };
        let filter = match self.filter {
            Filter::None | Filter::Exponential => true,
            Filter::Octahedral | Filter::Color => matches!(stride, 4 | 8),
            Filter::Quaternion => stride == 8,
        };
        mode && filter && (self.filter == Filter::None || self.mode == Mode::Attributes)
    }
}
