//! Pictures from files: PNG, JPEG, TIFF, WebP, HDR and EXR, recognized by their first bytes.

use std::fs;
use std::io::Cursor;
use std::path::Path;

use image::{DynamicImage, ImageDecoder};

use super::exr::{self, ExrFile, Picture, Selection};
use super::jpeg;
use crate::error::{Error, Result};
use crate::pixels::{MOST_PIXELS, Pixels, Precision, Samples};

/// First bytes of an EXR file.
const EXR: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];

/// What the numbers of a file stand for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ImageState {
    /// Encoded for displays, alpha apart from colour: PNG, JPEG, WebP and TIFF of integers.
    DisplayReferred,
    /// Linear light, colour multiplied by alpha: EXR, HDR and TIFF of floats.
    SceneReferred,
}

/// A picture with what is to be kept beside its pixels.
#[derive(Debug)]
pub struct Source {
    /// What is to be filtered: one picture, or one for each view of an EXR file.
    pub pictures: Vec<Picture>,
    /// What the numbers mean.
    pub state: ImageState,
    /// The colour profile of a PNG or JPEG file.
    pub profile: Option<Vec<u8>>,
    /// Everything else in an EXR file.
    pub exr: Option<ExrFile>,
}

/// Reads a picture, of an EXR file what `selection` chooses.
///
/// # Errors
/// As [`open`] and [`Opened::decode`].
pub fn read(path: &Path, selection: &Selection) -> Result<Source> {
    open(path, selection)?.decode(path)
}

/// A file in memory, of which nothing is decoded yet.
#[derive(Debug)]
pub struct Opened(Kind);

#[derive(Debug)]
enum Kind {
    Exr(exr::Opened),
    /// The bytes of another file, and what was selected as if it were an EXR file.
    Other(Vec<u8>, Option<&'static str>),
}

/// Reads a file's bytes, and what an EXR file says of itself.
///
/// # Errors
/// [`Error::Input`] when it is missing or cannot be read; when it is a damaged EXR file or one that lacks what
/// `selection` chooses.
pub fn open(path: &Path, selection: &Selection) -> Result<Opened> {
    let bytes =
        fs::read(path).map_err(|e| Error::file(path, format!("cannot be read: {e}"), "name a picture"))?;
    if bytes.starts_with(&EXR) {
        return exr::Opened::new(path, bytes, selection).map(Kind::Exr).map(Opened);
    }
    Ok(Opened(Kind::Other(bytes, selection.option())))
}

impl Opened {
    /// Bytes of memory that a picture takes from being decoded to being written, about. Files that will be refused
    /// weigh what they are.
    pub fn weight(&self) -> u64 {
        match &self.0 {
            Kind::Exr(file) => file.weight(),
            Kind::Other(bytes, _) => {
                // Four channels as decoded, as result, and as floats between.
                let pixels = self.size().map_or(0, |(width, height)| u64::from(width) * u64::from(height));
                bytes.len() as u64 + pixels * 4 * (2 + 2 + 8)
            }
        }
    }

    /// Size of the largest picture in a file; nothing for files that will be refused.
    pub fn size(&self) -> Option<(u32, u32)> {
        match &self.0 {
            Kind::Exr(file) => file.size(),
            Kind::Other(bytes, _) => {
                let reader = image::ImageReader::new(Cursor::new(bytes));
                reader.with_guessed_format().ok()?.into_dimensions().ok()
            }
        }
    }

    /// Makes pictures of it.
    ///
    /// # Errors
    /// [`Error::Input`] when the file is of another kind, truncated, malformed or too large, or cannot have what
    /// was selected.
    pub fn decode(self, path: &Path) -> Result<Source> {
        match self.0 {
            Kind::Exr(file) => {
                let exr = file.decode(path)?;
                let pictures = exr.pictures(path)?;
                Ok(Source { pictures, state: ImageState::SceneReferred, profile: None, exr: Some(exr) })
            }
            Kind::Other(_, Some(option)) => {
                Err(Error::input(option, format!("'{}' is no EXR file", path.display()), "leave it out"))
            }
            Kind::Other(bytes, None) => decode(path, &bytes),
        }
    }
}

/// Whether a file is a whole picture, and no beginning of one.
pub fn is_whole(path: &Path) -> bool {
    let Ok(bytes) = fs::read(path) else { return false };
    if bytes.starts_with(&EXR) {
        return exr::is_whole(bytes);
    }
    decode(path, &bytes).is_ok()
}

/// Makes a picture of the bytes of any file but an EXR file.
fn decode(path: &Path, bytes: &[u8]) -> Result<Source> {
    match bytes {
        [0x89, b'P', b'N', b'G', ..] => {
            let decoder = image::codecs::png::PngDecoder::new(Cursor::new(bytes));
            picture(path, decoder.map_err(|e| Error::malformed(path, "PNG", e))?, "PNG")
        }
        [0xff, 0xd8, 0xff, ..] => {
            if !jpeg::is_whole(bytes) {
                return Err(Error::malformed(path, "JPEG", "it ends before the picture does"));
            }
            let decoder = image::codecs::jpeg::JpegDecoder::new(Cursor::new(bytes));
            picture(path, decoder.map_err(|e| Error::malformed(path, "JPEG", e))?, "JPEG")
        }
        [b'I', b'I', 42, 0, ..] | [b'M', b'M', 0, 42, ..] => {
            let decoder = image::codecs::tiff::TiffDecoder::new(Cursor::new(bytes));
            picture(path, decoder.map_err(|e| Error::malformed(path, "TIFF", e))?, "TIFF")
        }
        [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] => {
            let decoder = image::codecs::webp::WebPDecoder::new(Cursor::new(bytes));
            picture(path, decoder.map_err(|e| Error::malformed(path, "WebP", e))?, "WebP")
        }
        [b'#', b'?', ..] => {
            let decoder = image::codecs::hdr::HdrDecoder::new(Cursor::new(bytes));
            picture(path, decoder.map_err(|e| Error::malformed(path, "HDR", e))?, "HDR")
        }
        [] => Err(Error::file(path, "is empty", "name a picture")),
        _ => Err(Error::file(
            path,
            "is neither PNG, JPEG nor EXR, nor TIFF, WebP or HDR",
            "convert it to one of them",
        )),
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

fn picture(path: &Path, mut decoder: impl ImageDecoder, kind: &str) -> Result<Source> {
    let (width, height) = decoder.dimensions();
    check_size(path, width.into(), height.into())?;
    let profile = decoder.icc_profile().unwrap_or_default();
    let orientation = decoder.orientation().map_err(|e| Error::malformed(path, kind, e))?;
    let mut decoded = DynamicImage::from_decoder(decoder).map_err(|e| Error::malformed(path, kind, e))?;
    // Nothing but the pixels is kept, so what the camera noted of its attitude is done here.
    decoded.apply_orientation(orientation);
    let (width, height) = (decoded.width(), decoded.height());
    let (channels, samples) = match decoded {
        DynamicImage::ImageLuma8(i) => (1, Samples::U8(i.into_raw())),
        DynamicImage::ImageRgb8(i) => (3, Samples::U8(i.into_raw())),
        DynamicImage::ImageLuma16(i) => (1, Samples::U16(i.into_raw())),
        DynamicImage::ImageRgb16(i) => (3, Samples::U16(i.into_raw())),
        DynamicImage::ImageRgba16(i) => (4, Samples::U16(i.into_raw())),
        DynamicImage::ImageRgb32F(i) => (3, Samples::F32(i.into_raw())),
        DynamicImage::ImageRgba32F(i) => (4, Samples::F32(i.into_raw())),
        DynamicImage::ImageLumaA16(_) => (4, Samples::U16(decoded.into_rgba16().into_raw())),
        other => (4, Samples::U8(other.into_rgba8().into_raw())),
    };
    let pixels = Pixels::new(width, height, channels, samples)
        .ok_or_else(|| Error::malformed(path, kind, "it does not hold as many pixels as it says"))?;
    let picture = Picture { pixels, guides: Vec::new(), chromaticities: None };
    let state = match picture.pixels.precision() {
        Precision::F16 | Precision::F32 => ImageState::SceneReferred,
        Precision::U8 | Precision::U16 => ImageState::DisplayReferred,
    };
    Ok(Source { pictures: vec![picture], state, profile, exr: None })
}
