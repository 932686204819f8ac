//! Pictures from files: PNG, JPEG and EXR, told apart by their first bytes.

use std::fs;
use std::io::Cursor;
use std::path::Path;

use image::{DynamicImage, ImageDecoder};

use super::exr::{ExrFile, Picture, Selection};
use super::jpeg;
use crate::error::{Error, Result};
use crate::pixels::{Pixels, Samples};

/// First bytes of an EXR file.
const EXR: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];
/// Most pixels of a picture.
const MOST_PIXELS: u64 = 1 << 28;

/// What a kind of file means by its numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// Encoded for displays, alpha apart from colour: PNG and JPEG.
    Display,
    /// Linear light, colour multiplied by alpha: EXR.
    Light,
}

/// A picture with what is to be kept beside its pixels.
#[derive(Debug)]
pub struct Source {
    /// What is to be filtered: one picture, or one for each view of an EXR file.
    pub pictures: Vec<Picture>,
    /// What the numbers mean.
    pub family: Family,
    /// The colour profile of a PNG or JPEG file.
    pub profile: Option<Vec<u8>>,
    /// Everything else in an EXR file.
    pub exr: Option<ExrFile>,
}

/// Reads a picture, of an EXR file what `selection` chooses.
///
/// # Errors
/// [`Error::Input`] when the file is missing, of another kind, truncated, malformed or too large, or lacks what was
/// chosen.
pub fn read(path: &Path, selection: &Selection) -> Result<Source> {
    let bytes = fs::read(path)
        .map_err(|e| Error::file(path, format!("cannot be read: {e}"), "name a PNG, JPEG or EXR file"))?;
    if !bytes.starts_with(&EXR)
        && let Some(option) = selection.option()
    {
        return Err(Error::input(option, format!("'{}' is no EXR file", path.display()), "leave it out"));
    }
    match bytes.as_slice() {
        [0x89, b'P', b'N', b'G', ..] => {
            let decoder = image::codecs::png::PngDecoder::new(Cursor::new(&bytes));
            decode(path, decoder.map_err(|e| malformed(path, "PNG", e))?, "PNG")
        }
        [0xff, 0xd8, 0xff, ..] => {
            if !jpeg::is_whole(&bytes) {
                return Err(malformed(path, "JPEG", "it ends before the picture does"));
            }
            let decoder = image::codecs::jpeg::JpegDecoder::new(Cursor::new(&bytes));
            decode(path, decoder.map_err(|e| malformed(path, "JPEG", e))?, "JPEG")
        }
        start if start.starts_with(&EXR) => {
            let exr = ExrFile::new(path, bytes, selection)?;
            let pictures = exr.pictures(path)?;
            Ok(Source { pictures, family: Family::Light, profile: None, exr: Some(exr) })
        }
        [] => Err(Error::file(path, "is empty", "name a PNG, JPEG or EXR file")),
        _ => Err(Error::file(path, "is neither PNG, JPEG nor EXR", "convert it to one of them")),
    }
}

/// Refuses sizes that a picture cannot have here.
///
/// # Errors
/// [`Error::Input`] for more than [`MOST_PIXELS`] pixels, or none.
pub fn check_size(path: &Path, width: u64, height: u64) -> Result<()> {
    match width.checked_mul(height) {
        Some(1..=MOST_PIXELS) => Ok(()),
        _ => Err(Error::file(
            path,
            format!("has {width}x{height} pixels"),
            format!("use a picture of 1 to {MOST_PIXELS} pixels"),
        )),
    }
}

/// The error of a file that its decoder refuses.
pub fn malformed(path: &Path, kind: &str, problem: impl std::fmt::Display) -> Error {
    Error::file(path, format!("is damaged and cannot be read as {kind}: {problem}"), "use an intact file")
}

fn decode(path: &Path, mut decoder: impl ImageDecoder, kind: &str) -> Result<Source> {
    let (width, height) = decoder.dimensions();
    check_size(path, width.into(), height.into())?;
    let profile = decoder.icc_profile().unwrap_or_default();
    let orientation = decoder.orientation().map_err(|e| malformed(path, kind, e))?;
    let mut decoded = DynamicImage::from_decoder(decoder).map_err(|e| malformed(path, kind, e))?;
    // Nothing but the pixels is kept, so what the camera noted of its attitude is done here.
    decoded.apply_orientation(orientation);
    let (width, height) = (decoded.width(), decoded.height());
    let (channels, samples) = match decoded {
        DynamicImage::ImageLuma8(i) => (1, Samples::U8(i.into_raw())),
        DynamicImage::ImageRgb8(i) => (3, Samples::U8(i.into_raw())),
        DynamicImage::ImageLuma16(i) => (1, Samples::U16(i.into_raw())),
        DynamicImage::ImageRgb16(i) => (3, Samples::U16(i.into_raw())),
        DynamicImage::ImageRgba16(i) => (4, Samples::U16(i.into_raw())),
        DynamicImage::ImageLumaA16(_) => (4, Samples::U16(decoded.into_rgba16().into_raw())),
        other => (4, Samples::U8(other.into_rgba8().into_raw())),
    };
    let pixels = Pixels::new(width, height, channels, samples)
        .ok_or_else(|| malformed(path, kind, "it does not hold as many pixels as it says"))?;
    let picture = Picture { pixels, guides: Vec::new(), chromaticities: None };
    Ok(Source { pictures: vec![picture], family: Family::Display, profile, exr: None })
}
