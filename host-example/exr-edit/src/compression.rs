//! Compressions by their number in a file: their names, and the scan lines in a chunk of each.
//!
//! Source: `Compression` of OpenEXR 3.5.

use crate::error::{Error, Result};

const NAMES: [&str; 14] = [
    "none", "RLE", "ZIPS", "ZIP", "PIZ", "PXR24", "B44", "B44A", "DWAA", "DWAB", "HTJ2K256", "HTJ2K32",
    "LJ2K", "ZSTD",
];

/// The name.
pub fn name(compression: u8) -> &'static str {
    NAMES.get(usize::from(compression)).copied().unwrap_or("unknown")
}

/// The error of a part whose compression is not read.
pub fn unread(compression: u8) -> Error {
    let problem = if usize::from(compression) < NAMES.len() {
        format!("is compressed by {}, which is not read", name(compression))
    } else {
        format!("is compressed by a method of number {compression}, which is not known")
    };
    Error::unsupported(problem, "save it with ZIP or PIZ compression")
}

/// Scan lines in a chunk.
///
/// # Errors
/// [`Error::Unsupported`] for compressions that are not known.
pub fn lines(compression: u8) -> Result<usize> {
    match compression {
        0..=2 | 13 => Ok(1),
        3 | 5 => Ok(16),
        4 | 6 | 7 | 8 | 11 => Ok(32),
        9 | 10 | 12 => Ok(256),
        other => Err(unread(other)),
    }
}
