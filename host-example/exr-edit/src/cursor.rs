//! Reading numbers and names from bytes that may end too early.

use crate::error::{Error, Result};

/// Longest name of an attribute, type or channel.
pub const LONGEST_NAME: usize = 255;

/// Bytes that are allocated for each byte of a text that is read: one that is no UTF-8 becomes three, in a string
/// that grows by doubling while the old one is copied, and is copied once more.
pub const TEXT_GROWTH: usize = 12;

/// A place in some bytes.
#[derive(Clone, Debug)]
pub struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Cursor<'a> {
    /// At the first byte.
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0 }
    }

    /// Bytes before this place.
    pub fn position(&self) -> usize {
        self.at
    }

    /// Bytes that are left.
    pub fn left(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// The bytes that are left, as they are.
    pub fn rest(&self) -> &'a [u8] {
        &self.bytes[self.at..]
    }

    /// True where nothing is left.
    pub fn is_empty(&self) -> bool {
        self.at == self.bytes.len()
    }

    /// The next byte, left where it is.
    pub fn peek(&self) -> Option<u8> {
        self.bytes.get(self.at).copied()
    }

    /// The next bytes, as a place of their own.
    pub fn take(&mut self, count: usize) -> Result<Cursor<'a>> {
        let end = self.at.checked_add(count).filter(|end| *end <= self.bytes.len());
        let end = end.ok_or_else(Error::ends)?;
        let taken = Cursor::new(&self.bytes[self.at..end]);
        self.at = end;
        Ok(taken)
    }

    /// Goes on behind the next bytes.
    pub fn skip(&mut self, count: usize) -> Result<()> {
        self.take(count).map(drop)
    }

    /// So many bytes.
    pub fn array<const N: usize>(&mut self) -> Result<[u8; N]> {
        let taken = self.take(N)?;
        taken.bytes.first_chunk().copied().ok_or_else(Error::ends)
    }

    /// One byte.
    pub fn u8(&mut self) -> Result<u8> {
        Ok(self.array::<1>()?[0])
    }

    /// A little-endian number.
    pub fn u32(&mut self) -> Result<u32> {
        self.array().map(u32::from_le_bytes)
    }

    /// A little-endian number.
    pub fn i32(&mut self) -> Result<i32> {
        self.array().map(i32::from_le_bytes)
    }

    /// A little-endian number.
    pub fn u64(&mut self) -> Result<u64> {
        self.array().map(u64::from_le_bytes)
    }

    /// So many little-endian floats.
    pub fn floats<const N: usize>(&mut self) -> Result<[f32; N]> {
        let mut floats = [0.0; N];
        for float in &mut floats {
            *float = f32::from_le_bytes(self.array()?);
        }
        Ok(floats)
    }

    /// Everything up to the end, as text; at most [`TEXT_GROWTH`] times as many bytes are allocated on the way.
    pub fn text(&mut self) -> String {
        let rest = &self.bytes[self.at..];
        self.at = self.bytes.len();
        String::from_utf8_lossy(rest).trim_end_matches('\0').to_owned()
    }

    /// Text that ends with a zero. Names that are not UTF-8 could not be written back.
    pub fn name(&mut self) -> Result<&'a str> {
        let rest = &self.bytes[self.at..];
        let length = rest.iter().take(LONGEST_NAME + 1).position(|b| *b == 0);
        let length = length.ok_or_else(|| Error::damaged("a name does not end"))?;
        let name = std::str::from_utf8(&rest[..length]).map_err(|_| Error::damaged("a name is no text"))?;
        self.at += length + 1;
        Ok(name)
    }
}
