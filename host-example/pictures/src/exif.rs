//! Colours that a camera notes in a JPEG file: Adobe RGB, which it may name without a profile.
//!
//! Source: Exif 3.0 (CIPA DC-008), sections 4.6.3 and 4.6.6; DCF 2.0 (CIPA DC-009), option files.

/// The part of a file that says which colours are meant.
pub const NAME: &str = "Exif";
/// Tags of the folders within, and of what they say of colours.
const CAMERA: u16 = 0x8769;
const INTEROPERABILITY: u16 = 0xa005;
const COLOR_SPACE: u16 = 0xa001;
const INDEX: u16 = 1;
/// A number that some cameras give to Adobe RGB, and the usual sign of it.
const ADOBE: u16 = 2;
const OPTION_FILE: &[u8] = b"R03";

/// True where a camera says that its numbers are Adobe RGB.
pub fn is_adobe_rgb(exif: &[u8]) -> bool {
    let bytes = exif.strip_prefix(b"Exif\0\0").unwrap_or(exif);
    let is_big = match bytes.get(..2) {
        Some(b"MM") => true,
        Some(b"II") => false,
        _ => return false,
    };
    let file = Folders { bytes, is_big };
    let found = || {
        let camera = file.long(file.entry(file.number(4)?, CAMERA)?);
        let is_named = file.entry(camera?, COLOR_SPACE).is_some_and(|value| file.short(value) == Some(ADOBE));
        let option = || {
            let folder = file.long(file.entry(camera?, INTEROPERABILITY)?)?;
            Some(file.entry(folder, INDEX)?.starts_with(OPTION_FILE))
        };
        Some(is_named || option() == Some(true))
    };
    found() == Some(true)
}

struct Folders<'a> {
    bytes: &'a [u8],
    is_big: bool,
}

impl<'a> Folders<'a> {
    fn short(&self, at: &[u8]) -> Option<u16> {
        let bytes = *at.first_chunk()?;
        Some(if self.is_big { u16::from_be_bytes(bytes) } else { u16::from_le_bytes(bytes) })
    }

    fn long(&self, at: &[u8]) -> Option<usize> {
        let bytes = *at.first_chunk()?;
        Some(if self.is_big { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) } as usize)
    }

    fn number(&self, at: usize) -> Option<usize> {
        self.long(self.bytes.get(at..)?)
    }

    /// The four bytes of an entry's value.
    fn entry(&self, folder: usize, tag: u16) -> Option<&'a [u8]> {
        let count = self.short(self.bytes.get(folder..)?)?;
        let entries = self.bytes.get(folder + 2..)?.as_chunks::<12>().0;
        let mut entries = entries.iter().take(count.into());
        entries.find(|entry| self.short(&entry[..]) == Some(tag)).map(|entry| &entry[8..])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three folders, of which the last names an option file.
    fn exif(index: &[u8; 4], color_space: u16) -> Vec<u8> {
        let mut bytes = b"MM\0\x2a\0\0\0\x08".to_vec();
        let folder = |bytes: &mut Vec<u8>, entries: &[(u16, u16, u32)]| {
            bytes.extend((entries.len() as u16).to_be_bytes());
            for (tag, kind, value) in entries {
                bytes.extend(tag.to_be_bytes());
                bytes.extend(kind.to_be_bytes());
                bytes.extend(1u32.to_be_bytes());
                bytes.extend(value.to_be_bytes());
            }
            bytes.extend([0; 4]);
        };
        folder(&mut bytes, &[(CAMERA, 4, 26)]);
        folder(&mut bytes, &[(COLOR_SPACE, 3, u32::from(color_space) << 16), (INTEROPERABILITY, 4, 56)]);
        folder(&mut bytes, &[(INDEX, 2, u32::from_be_bytes(*index))]);
        bytes
    }

    #[test]
    fn adobe_rgb_is_found() {
        assert!(is_adobe_rgb(&exif(b"R03\0", 0xffff)) && is_adobe_rgb(&exif(b"R98\0", ADOBE)));
        assert!(!is_adobe_rgb(&exif(b"R98\0", 1)));
        let bytes = exif(b"R03\0", 0xffff);
        // The last four bytes lead to another folder.
        for length in 0..bytes.len() - 4 {
            assert!(!is_adobe_rgb(&bytes[..length]));
        }
    }
}
