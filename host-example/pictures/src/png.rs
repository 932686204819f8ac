//! Chunks of PNG files (ISO/IEC 15948): whether all are there, and the shape of pixels (`pHYs`), which decoders and encoders leave out.
//! Decoders have all pixels before the last chunk, and some of the one before it.

use std::io::{self, Write};

use crate::display::densities;

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

/// Length of the signature with the first chunk, behind which others may stand.
const HEAD: usize = SIGNATURE + FRAME + 13;
/// Name of the chunk that tells the shape of pixels.
const SHAPE: &[u8; 4] = b"pHYs";

/// Width of a pixel over its height, where the file says that they differ.
pub fn pixel_aspect(bytes: &[u8]) -> Option<f32> {
    let mut rest = bytes.get(SIGNATURE..)?;
    loop {
        let length = u32::from_be_bytes(*rest.first_chunk()?) as usize;
        let data = rest.get(8..8 + length)?;
        match rest.get(4..8)? {
            name if name == SHAPE => {
                let number = |at: usize| Some(u32::from_be_bytes(*data.get(at..)?.first_chunk()?));
                let (across, down) = (number(0)?, number(4)?);
                let aspect = (f64::from(down) / f64::from(across)) as f32;
                return Some(aspect).filter(|aspect| (0.01..=100.0).contains(aspect) && across != down);
            }
            b"IDAT" => return None,
            _ => rest = rest.get(length.checked_add(FRAME)?..)?,
        }
    }
}

/// A file to which an encoder writes a PNG, which gets the shape of its pixels on the way.
pub struct Shaped<W> {
    file: W,
    /// Bytes that are written before the chunk.
    before: usize,
    chunk: Vec<u8>,
}

impl<W: Write> Shaped<W> {
    /// A file for a picture of such pixels.
    pub fn new(file: W, pixel_aspect: f32) -> Self {
        let chunk = if pixel_aspect == 1.0 { Vec::new() } else { shape(pixel_aspect) };
        Self { file, before: HEAD, chunk }
    }
}

impl<W: Write> Write for Shaped<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.before > 0 {
            let taken = self.file.write(&bytes[..bytes.len().min(self.before)])?;
            self.before -= taken;
            return Ok(taken);
        }
        let chunk = std::mem::take(&mut self.chunk);
        self.file.write_all(&chunk)?;
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

/// The chunk for pixels of such a shape, in no unit.
fn shape(pixel_aspect: f32) -> Vec<u8> {
    let [across, down] = densities(pixel_aspect);
    let mut named = SHAPE.to_vec();
    named.extend(across.to_be_bytes().into_iter().chain(down.to_be_bytes()).chain([0]));
    let mut chunk = (named.len() as u32 - 4).to_be_bytes().to_vec();
    chunk.extend(&named);
    chunk.extend(checksum(&named).to_be_bytes());
    chunk
}

/// CRC-32 of a chunk's name and data (annex D).
fn checksum(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| (crc >> 1) ^ (0xedb8_8320 * (crc & 1)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_of_pixels_are_written_and_read() {
        let picture = image::RgbImage::from_pixel(3, 2, image::Rgb([9, 8, 7]));
        for aspect in [1.0, 2.0, 0.75] {
            let mut bytes = Vec::new();
            let encoder = image::codecs::png::PngEncoder::new(Shaped::new(&mut bytes, aspect));
            picture.write_with_encoder(encoder).unwrap();
            assert!(is_whole(&bytes));
            assert_eq!(pixel_aspect(&bytes).unwrap_or(1.0), aspect);
            let read = image::load_from_memory(&bytes).unwrap();
            assert_eq!(read.into_rgb8(), picture);
            (0..bytes.len()).for_each(|length| drop(pixel_aspect(&bytes[..length])));
        }
        assert_eq!(checksum(b"IEND"), 0xae42_6082);
    }

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
