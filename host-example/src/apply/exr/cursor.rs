//! Reading numbers and names from bytes that may end too early.

use super::Fault;

/// Longest name of an attribute, type or channel.
const LONGEST_NAME: usize = 255;

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

    /// Bytes in all.
    pub fn len(&self) -> usize {
        self.bytes.len()
    }

    /// Whether nothing is left.
    pub fn is_empty(&self) -> bool {
        self.at == self.bytes.len()
    }

    /// The next byte, left where it is.
    pub fn peek(&self) -> Option<u8> {
        self.bytes.get(self.at).copied()
    }

    /// The next bytes, as a place of their own.
    pub fn take(&mut self, count: usize) -> Result<Cursor<'a>, Fault> {
        let end = self.at.checked_add(count).filter(|end| *end <= self.bytes.len());
        let end = end.ok_or_else(|| Fault::damaged("it ends before the picture does"))?;
        let taken = Cursor::new(&self.bytes[self.at..end]);
        self.at = end;
        Ok(taken)
    }

    /// Goes on behind the next bytes.
    pub fn skip(&mut self, count: usize) -> Result<(), Fault> {
        self.take(count).map(drop)
    }

    /// So many bytes.
    pub fn array<const N: usize>(&mut self) -> Result<[u8; N], Fault> {
        let taken = self.take(N)?;
        taken.bytes.first_chunk().copied().ok_or_else(|| Fault::damaged("it ends before the picture does"))
    }

    /// One byte.
    pub fn u8(&mut self) -> Result<u8, Fault> {
        Ok(self.array::<1>()?[0])
    }

    /// A little-endian number.
    pub fn u32(&mut self) -> Result<u32, Fault> {
        self.array().map(u32::from_le_bytes)
    }

    /// A little-endian number.
    pub fn i32(&mut self) -> Result<i32, Fault> {
        self.array().map(i32::from_le_bytes)
    }

    /// A little-endian number.
    pub fn u64(&mut self) -> Result<u64, Fault> {
        self.array().map(u64::from_le_bytes)
    }

    /// So many little-endian floats.
    pub fn floats<const N: usize>(&mut self) -> Result<[f32; N], Fault> {
        let mut floats = [0.0; N];
        for float in &mut floats {
            *float = f32::from_le_bytes(self.array()?);
        }
        Ok(floats)
    }

    /// Everything up to the end, as text.
    pub fn rest(&mut self) -> String {
        let rest = &self.bytes[self.at..];
        self.at = self.bytes.len();
        String::from_utf8_lossy(rest).trim_end_matches('\0').to_owned()
    }

    /// Text that ends with a zero. Names that are not UTF-8 could not be written back.
    pub fn name(&mut self) -> Result<String, Fault> {
        let rest = &self.bytes[self.at..];
        let length = rest.iter().take(LONGEST_NAME + 1).position(|b| *b == 0);
        let length = length.ok_or_else(|| Fault::damaged("a name does not end"))?;
        let name = std::str::from_utf8(&rest[..length]).map_err(|_| Fault::damaged("a name is no text"))?;
        self.at += length + 1;
        Ok(name.to_owned())
    }
}
