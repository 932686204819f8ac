//! Checks that a PNG file is whole. Decoders have all pixels before the last chunk, and some of the one before it.

/// Length of the signature at the start.
const SIGNATURE: usize = 8;
/// Bytes of a chunk beside its data: length, type and checksum.
const FRAME: usize = 12;
/// The last chunk, which holds no data, so that it is always the same.
const END: [u8; FRAME] = [0, 0, 0, 0, b'I', b'E', b'N', b'D', 0xae, 0x42, 0x60, 0x82];

/// Walks the chunks of a PNG file (ISO/IEC 15948, section 5) to the last, and says whether it is there.
pub fn is_whole(bytes: &[u8]) -> bool {
    let mut rest = bytes.get(SIGNATURE..).unwrap_or_default();
    while let Some(length) = rest.first_chunk() {
        if rest.starts_with(&END) {
            return true;
        }
        let length = u32::from_be_bytes(*length) as usize;
        rest = rest.get(length.saturating_add(FRAME)..).unwrap_or_default();
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_files_end_and_every_beginning_of_one_does_not() {
        let mut bytes = std::io::Cursor::new(Vec::new());
        let picture = image::RgbImage::from_fn(24, 16, |x, y| image::Rgb([x as u8, y as u8, (x * y) as u8]));
        picture.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
        let bytes = bytes.into_inner();
        assert!(is_whole(&bytes));
        assert!(is_whole(&[bytes.as_slice(), b"appended"].concat()));
        for length in 0..bytes.len() {
            assert!(!is_whole(&bytes[..length]), "{length} of {}", bytes.len());
        }
    }
}
