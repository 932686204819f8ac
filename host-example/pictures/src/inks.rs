//! Pictures of inks (CMYK) in JPEG and TIFF files, as they are before anything makes colours of them.
//!
//! Source: ISO/IEC 10918-6 (Adobe's marker in JPEG), TIFF 6.0, section 16.

use std::io::Cursor;

use tiff::ColorType;
use tiff::decoder::{Decoder, DecodingResult, Limits};
use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

use crate::jpeg;
use crate::pixels::{Pixels, Samples};
use crate::tiff::interleaved;

/// Number of inks: cyan, magenta, yellow, black.
const INKS: u32 = 4;

/// True for a JPEG or TIFF file of inks.
pub fn are_in(kind: &str, bytes: &[u8]) -> bool {
    match kind {
        "JPEG" => of_jpeg(bytes).is_some(),
        "TIFF" => matches!(color_type(bytes), Some(ColorType::CMYK(8 | 16))),
        _ => false,
    }
}

/// The inks of a file, 0 for none; nothing where they cannot be decoded in so many bytes.
pub fn read(kind: &str, bytes: &[u8], most: usize) -> Option<Pixels> {
    if kind == "JPEG" { read_jpeg(bytes) } else { read_tiff(bytes, most) }
}

/// Coding of the inks of a JPEG file; nothing for other colours.
fn of_jpeg(bytes: &[u8]) -> Option<ColorSpace> {
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options());
    decoder.decode_headers().ok()?;
    decoder.input_colorspace().filter(|space| matches!(space, ColorSpace::CMYK | ColorSpace::YCCK))
}

/// Options of the decoder that reads all other JPEG files.
fn options() -> DecoderOptions {
    DecoderOptions::default().set_strict_mode(false).set_max_width(usize::MAX).set_max_height(usize::MAX)
}

fn read_jpeg(bytes: &[u8]) -> Option<Pixels> {
    let space = of_jpeg(bytes)?;
    let options = options().jpeg_set_out_colorspace(space);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    let mut samples = decoder.decode().ok()?;
    let (width, height) = decoder.info().map(|info| (u32::from(info.width), u32::from(info.height)))?;
    if space == ColorSpace::YCCK {
        for [y, cb, cr, _] in samples.as_chunks_mut::<4>().0 {
            let (luma, blue, red) = (f32::from(*y), f32::from(*cb) - 128.0, f32::from(*cr) - 128.0);
            let rgb = [luma + 1.402 * red, luma - 0.344_136 * blue - 0.714_136 * red, luma + 1.772 * blue];
            [*y, *cb, *cr] = rgb.map(|v| (v.clamp(0.0, 255.0) + 0.5) as u8);
        }
    }
    if space == ColorSpace::YCCK || jpeg::is_of_adobe(bytes) {
        // Adobe writes what the inks leave of the paper.
        samples.iter_mut().for_each(|ink| *ink = 255 - *ink);
    }
    Pixels::new(width, height, INKS, Samples::U8(samples))
}

fn color_type(bytes: &[u8]) -> Option<ColorType> {
    Decoder::new(Cursor::new(bytes)).ok()?.colortype().ok()
}

fn read_tiff(bytes: &[u8], most: usize) -> Option<Pixels> {
    let mut limits = Limits::default();
    limits.decoding_buffer_size = most;
    limits.intermediate_buffer_size = most;
    limits.ifd_value_size = most;
    let mut decoder = Decoder::new(Cursor::new(bytes)).ok()?.with_limits(limits);
    let (width, height) = decoder.dimensions().ok()?;
    let mut decoded = DecodingResult::U8(Vec::new());
    let layout = decoder.read_image_to_buffer(&mut decoded).ok()?;
    let is_planar = layout.planes > 1;
    let samples = match decoded {
        DecodingResult::U8(samples) => Samples::U8(interleaved(samples, is_planar, INKS as usize)),
        DecodingResult::U16(samples) => Samples::U16(interleaved(samples, is_planar, INKS as usize)),
        _ => return None,
    };
    Pixels::new(width, height, INKS, samples)
}
