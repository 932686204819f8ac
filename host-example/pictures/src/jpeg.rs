//! Checks that a JPEG file is whole. Decoders fill what is missing with grey and say nothing.

/// Walks the markers of a JPEG file (ISO/IEC 10918-1, annex B) to the end-of-image marker, and says whether
/// there is one.
pub fn is_whole(bytes: &[u8]) -> bool {
    const START_OF_SCAN: u8 = 0xda;
    const END_OF_IMAGE: u8 = 0xd9;
    let mut at = 2;
    loop {
        // Any number of fill bytes may precede a marker.
        while bytes.get(at) == Some(&0xff) && bytes.get(at + 1) == Some(&0xff) {
            at += 1;
        }
        let (Some(0xff), Some(&marker)) = (bytes.get(at), bytes.get(at + 1)) else { return false };
        at += 2;
        match marker {
            END_OF_IMAGE => return true,
            // Restart markers, start of image and the temporary marker stand alone.
            0xd0..=0xd8 | 0x01 => {}
            _ => {
                let Some(length) = bytes.get(at..at + 2) else { return false };
                at += usize::from(u16::from_be_bytes([length[0], length[1]]));
            }
        }
        if matches!(marker, START_OF_SCAN | 0xd0..=0xd7) {
            // Coded data: a zero after 0xff is stuffed, not a marker.
            while let Some(&[first, second]) = bytes.get(at..at + 2).and_then(|b| b.first_chunk()) {
                if first == 0xff && second != 0 {
                    break;
                }
                at += 1;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn encoded() -> Vec<u8> {
        let pixels: Vec<u8> = (0..64 * 48 * 3).map(|i| (i * 37 % 251) as u8).collect();
        let mut bytes = Vec::new();
        let encoder = image::codecs::jpeg::JpegEncoder::new_with_quality(&mut bytes, 90);
        image::ImageEncoder::write_image(encoder, &pixels, 64, 48, image::ExtendedColorType::Rgb8).unwrap();
        bytes
    }

    #[test]
    fn whole_files_end_and_every_beginning_of_one_does_not() {
        let bytes = encoded();
        assert!(is_whole(&bytes));
        assert!(is_whole(&[bytes.as_slice(), b"appended by a camera"].concat()));
        for length in 0..bytes.len() {
            assert!(!is_whole(&bytes[..length]), "{length} of {}", bytes.len());
        }
    }
}
