//! Markers of JPEG files (ISO/IEC 10918-1, annex B): whether all are there, and whose they are.

const START_OF_SCAN: u8 = 0xda;
const END_OF_IMAGE: u8 = 0xd9;
const ADOBE: u8 = 0xee;

/// Walks the markers to the end-of-image marker, and says whether there is one. Decoders fill what is missing with grey and
/// say nothing.
pub fn is_whole(bytes: &[u8]) -> bool {
    Markers { bytes, at: 2 }.any(|(marker, _)| marker == END_OF_IMAGE)
}

/// True where a marker says that a program of Adobe's, or one that writes as they do, made the file.
pub fn is_of_adobe(bytes: &[u8]) -> bool {
    let mut before = Markers { bytes, at: 2 }.take_while(|(marker, _)| *marker != START_OF_SCAN);
    before.any(|(marker, data)| marker == ADOBE && data.starts_with(b"Adobe"))
}

/// Markers with the data of their segments.
struct Markers<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Iterator for Markers<'a> {
    type Item = (u8, &'a [u8]);

    fn next(&mut self) -> Option<Self::Item> {
        let Self { bytes, at } = self;
        // Any number of fill bytes may precede a marker.
        while bytes.get(*at) == Some(&0xff) && bytes.get(*at + 1) == Some(&0xff) {
            *at += 1;
        }
        let (Some(0xff), Some(&marker)) = (bytes.get(*at), bytes.get(*at + 1)) else { return None };
        *at += 2;
        let mut data: &[u8] = &[];
        match marker {
            // Restart markers, start and end of image and the temporary marker stand alone.
            0xd0..=0xd9 | 0x01 => {}
            _ => {
                let length = usize::from(u16::from_be_bytes(*bytes.get(*at..)?.first_chunk()?));
                data = bytes.get(*at + 2..*at + length).unwrap_or_default();
                *at += length;
            }
        }
        if matches!(marker, START_OF_SCAN | 0xd0..=0xd7) {
            // Coded data: a zero after 0xff is stuffed, not a marker.
            while let Some(&[first, second]) = bytes.get(*at..*at + 2).and_then(|b| b.first_chunk()) {
                if first == 0xff && second != 0 {
                    break;
                }
                *at += 1;
            }
        }
        Some((marker, data))
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
