//! Pictures from files: PNG, JPEG, TIFF, WebP, HDR and EXR, recognized by their first bytes.

use std::fs::File;
use std::io::{self, Cursor, Read};
use std::path::Path;

use image::codecs::jpeg::JpegDecoder;
use image::codecs::png::PngDecoder;
use image::codecs::tiff::TiffDecoder;
use image::codecs::webp::WebPDecoder;
use image::{DynamicImage, ImageDecoder, ImageError, ImageResult, Limits};

use crate::convert::Conversion;
use crate::exr::{self, ExrFile, Offers, Picture, Selection};
use crate::meaning::{ImageState, Meaning};
use crate::pixels::{MOST_PIXELS, Pixels, Samples};
use crate::primaries::{Change, REC709};
use crate::tiff::Wide;
use crate::{colours, hdr, jpeg, png, said, svg, weight};
use isophote_exr_edit::create::MAGIC;
use isophote_files::error::{Error, Result};
use isophote_files::frames;
use isophote_files::input;
use isophote_files::limits;

/// Bytes that a decoder may take for the smallest picture: its tables and texts.
const LEAST: u64 = 64 << 20;

/// A picture with what is to be kept beside its pixels.
#[derive(Debug)]
pub struct Source {
    /// Pictures to be filtered: one, or one for each view of an EXR file.
    pub pictures: Vec<Picture>,
    /// Everything else in an EXR file.
    pub exr: Option<ExrFile>,
}

impl Source {
    /// A picture of which nothing else is known than what its numbers mean.
    pub fn alone(pixels: Pixels, meaning: Meaning) -> Self {
        Self { pictures: vec![Picture::alone(pixels, meaning)], exr: None }
    }

    /// State of the numbers, which is that of all pictures of a file.
    pub fn state(&self) -> ImageState {
        self.pictures.first().map_or(ImageState::DisplayReferred, |picture| picture.meaning.state)
    }

    /// Makes sure that there can be results of all pictures.
    ///
    /// # Errors
    /// The reason why there can be none.
    pub fn check(&self) -> Result<()> {
        self.pictures.iter().find_map(|picture| picture.refused.clone()).map_or(Ok(()), Err)
    }
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
    Exr(Box<exr::Opened>),
    /// The bytes of another file, and what was selected as if it were an EXR file.
    Other(Vec<u8>, Option<&'static str>),
}

/// Reads a file's bytes, and what an EXR file says of itself.
///
/// # Errors
/// [`Error::Input`] when it is missing or cannot be read; when it is a damaged EXR file or one that lacks what
/// `selection` chooses.
pub fn open(path: &Path, selection: &Selection) -> Result<Opened> {
    Unread::open(path)?.read(path, selection)
}

/// A file in memory, by its kind.
#[derive(Debug)]
pub enum Any {
    /// The bytes of an EXR file.
    Exr(Vec<u8>),
    /// Another picture.
    Other(Opened),
}

/// An open file of which nothing is read yet. Whatever takes its place on disk meanwhile, this is what is read.
#[derive(Debug)]
pub struct Unread {
    file: File,
    length: u64,
}

impl Unread {
    /// Opens a file.
    ///
    /// # Errors
    /// [`Error::Input`] when it is missing or cannot be opened; when it is a folder, or a pipe or a device, which might
    /// not end.
    pub fn open(path: &Path) -> Result<Self> {
        let (file, found) = input::open(path).map_err(|e| unreadable(path, &e))?;
        if found.is_dir() {
            return Err(Error::file(path, "is a folder and cannot be read as a picture", hint(path)));
        }
        if !found.is_file() {
            let problem = "is a pipe or a device and cannot be read as a picture";
            return Err(Error::file(path, problem, "write the picture to a file first"));
        }
        Ok(Self { file, length: found.len() })
    }

    /// Length of the file in bytes; no more is read.
    pub fn length(&self) -> u64 {
        self.length
    }

    /// Reads it.
    ///
    /// # Errors
    /// As [`open`].
    pub fn read(self, path: &Path, selection: &Selection) -> Result<Opened> {
        let bytes = self.bytes(path)?;
        if bytes.starts_with(&MAGIC) {
            let opened = exr::Opened::new(path, bytes, selection)?;
            return Ok(Opened(Kind::Exr(Box::new(opened))));
        }
        Ok(Opened(Kind::Other(bytes, selection.option())))
    }

    /// Reads it without taking anything apart.
    ///
    /// # Errors
    /// As [`open`].
    pub fn any(self, path: &Path) -> Result<Any> {
        let bytes = self.bytes(path)?;
        Ok(if bytes.starts_with(&MAGIC) {
            Any::Exr(bytes)
        } else {
            Any::Other(Opened(Kind::Other(bytes, None)))
        })
    }

    /// All of it.
    ///
    /// # Errors
    /// As [`open`].
    pub fn bytes(self, path: &Path) -> Result<Vec<u8>> {
        let mut bytes = Vec::new();
        let room = usize::try_from(self.length).ok().and_then(|length| bytes.try_reserve_exact(length).ok());
        let read = match room {
            Some(()) => self.file.take(self.length).read_to_end(&mut bytes),
            None => Err(io::ErrorKind::OutOfMemory.into()),
        };
        read.map_err(|e| unreadable(path, &e))?;
        Ok(bytes)
    }
}

impl Opened {
    /// Bytes of memory that a picture takes from being decoded to being written, about. `keeps_samples` says that nothing
    /// asks for other samples in the result. Files that will be refused weigh what they are.
    pub fn weight(&self, keeps_samples: bool) -> u64 {
        match &self.0 {
            Kind::Exr(file) => file.weight(),
            Kind::Other(bytes, _) => {
                let Ok((kind, decoder)) = decoder(Path::new(""), bytes) else {
                    return bytes.len() as u64;
                };
                weight::of_decoded(kind, bytes, decoder, keeps_samples).saturating_add(bytes.len() as u64)
            }
        }
    }

    /// True for files that may have other layers beside the picture.
    pub fn has_layers(&self) -> bool {
        matches!(self.0, Kind::Exr(_))
    }

    /// Width of a pixel over its height; of an EXR file that of its largest picture.
    pub fn pixel_aspect(&self) -> f64 {
        match &self.0 {
            Kind::Exr(file) => file.pixel_aspect(),
            Kind::Other(bytes, _) => f64::from(said::pixel_aspect(kind(bytes), bytes).unwrap_or(1.0)),
        }
    }

    /// Name of the file's format.
    pub fn kind(&self) -> &'static str {
        match &self.0 {
            Kind::Exr(_) => "EXR",
            Kind::Other(bytes, _) => kind(bytes),
        }
    }

    /// Choices that the file offers: layers and views of an EXR file, nothing in others.
    pub fn offers(&self) -> Offers {
        match &self.0 {
            Kind::Exr(file) => file.offers(),
            Kind::Other(..) => Offers::default(),
        }
    }

    /// Size of the largest picture in a file; nothing for files that will be refused.
    pub fn size(&self) -> Option<(u32, u32)> {
        match &self.0 {
            Kind::Exr(file) => file.size(),
            Kind::Other(bytes, _) => {
                decoder(Path::new(""), bytes).ok().map(|(_, decoder)| decoder.dimensions())
            }
        }
    }

    /// Makes pictures of it.
    ///
    /// # Errors
    /// [`Error::Input`] when the file is of another kind, truncated, malformed or too large, or cannot have what
    /// was selected.
    pub fn decode(self, path: &Path) -> Result<Source> {
        let source = match self.0 {
            Kind::Exr(file) => {
                let exr = file.decode(path)?;
                let pictures = exr.pictures(path)?;
                Source { pictures, exr: Some(exr) }
            }
            Kind::Other(_, Some(option)) => {
                return Err(Error::input(
                    option,
                    format!("'{}' is no EXR file", path.display()),
                    "leave it out",
                ));
            }
            Kind::Other(bytes, None) => decode(path, &bytes)?,
        };
        let name = path.display().to_string();
        source.pictures.iter().for_each(|picture| picture.meaning.tell(&name));
        Ok(source)
    }
}

fn unreadable(path: &Path, problem: &io::Error) -> Error {
    match problem.kind() {
        io::ErrorKind::OutOfMemory => limits::too_little(&path.display().to_string()),
        _ => Error::file(path, format!("cannot be read: {problem}"), hint(path)),
    }
}

/// Hint at what somebody may have meant who named this path.
fn hint(path: &Path) -> String {
    match frames::meant(path) {
        Some(pattern) => format!("write {} for a sequence, or name a picture", pattern.display()),
        None => "name a picture".into(),
    }
}

/// True where a file is a whole picture, and no beginning of one.
pub fn is_whole(path: &Path) -> bool {
    let Ok(bytes) = Unread::open(path).and_then(|file| file.bytes(path)) else { return false };
    if bytes.starts_with(&MAGIC) {
        return exr::is_whole(bytes);
    }
    if bytes.starts_with(b"<svg") {
        return svg::is_whole(&bytes);
    }
    decode(path, &bytes).is_ok()
}

/// Makes a picture of the bytes of any file but an EXR file.
fn decode(path: &Path, bytes: &[u8]) -> Result<Source> {
    let is_whole = match bytes {
        [0x89, b'P', b'N', b'G', ..] => png::is_whole(bytes),
        [0xff, 0xd8, 0xff, ..] => jpeg::is_whole(bytes),
        _ => true,
    };
    let (kind, decoder) = decoder(path, bytes)?;
    if !is_whole {
        return Err(Error::malformed(path, kind, "it ends before the picture does"));
    }
    let mut source = picture(path, decoder, (kind, bytes))?;
    for picture in &mut source.pictures {
        said::add(kind, bytes, picture);
    }
    if kind == "HDR"
        && let Some(primaries) = hdr::primaries(bytes)
    {
        if Change::new(primaries, REC709).is_none() {
            return Err(Error::malformed(path, kind, "its PRIMARIES span no colours"));
        }
        for Picture { pixels, meaning, .. } in &mut source.pictures {
            // Results keep no header that could say so.
            if let Some(change) = Conversion::between(&Meaning { primaries, ..meaning.clone() }, meaning) {
                *pixels = change.apply(pixels).0;
            }
            meaning.said_by = Some("PRIMARIES");
        }
    }
    Ok(source)
}

/// The format of any file but an EXR file; nothing where it cannot be read.
fn kind(bytes: &[u8]) -> &'static str {
    decoder(Path::new(""), bytes).map_or("", |(kind, _)| kind)
}

/// The kind of any file but an EXR file, and a decoder that has read what it says of itself.
fn decoder<'a>(path: &Path, bytes: &'a [u8]) -> Result<(&'static str, Box<dyn ImageDecoder + 'a>)> {
    fn boxed<'a, D: ImageDecoder + 'a>(
        path: &Path,
        kind: &'static str,
        decoder: ImageResult<D>,
    ) -> Result<(&'static str, Box<dyn ImageDecoder + 'a>)> {
        match decoder {
            Ok(decoder) => Ok((kind, Box::new(decoder))),
            Err(problem) => Err(refused(path, kind, &problem)),
        }
    }
    let start = Cursor::new(bytes);
    match bytes {
        [0x89, b'P', b'N', b'G', ..] => boxed(path, "PNG", PngDecoder::new(start)),
        [0xff, 0xd8, 0xff, ..] => boxed(path, "JPEG", JpegDecoder::new(start)),
        // The second number is that of BigTIFF, for files of more than 4 GiB.
        [b'I', b'I', 42 | 43, 0, ..] | [b'M', b'M', 0, 42 | 43, ..] => match Wide::new(bytes) {
            Some(decoder) => Ok(("TIFF", Box::new(decoder))),
            None => boxed(path, "TIFF", TiffDecoder::new(start)),
        },
        [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] => {
            boxed(path, "WebP", WebPDecoder::new(start))
        }
        [b'#', b'?', ..] => boxed(path, "HDR", hdr::decoder(bytes)),
        [] => Err(Error::file(path, "is empty", "name a picture")),
        _ => Err(Error::file(
            path,
            "is neither PNG, JPEG nor EXR, nor TIFF, WebP or HDR",
            "convert it to one of them",
        )),
    }
}

/// The error of a picture that its decoder refuses: files that are whole may be of a kind that is not read.
fn refused(path: &Path, kind: &str, problem: &ImageError) -> Error {
    match problem {
        ImageError::Unsupported(_) => Error::file(
            path,
            format!("is {kind} of a kind that is not read: {problem}"),
            "save it as usual 8 or 16 bit colour",
        ),
        ImageError::Limits(_) => {
            Error::file(path, format!("takes too much memory to be read as {kind}"), "use a smaller picture")
        }
        _ => Error::malformed(path, kind, problem),
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

fn picture(path: &Path, mut decoder: impl ImageDecoder, (kind, bytes): (&str, &[u8])) -> Result<Source> {
    let (width, height) = decoder.dimensions();
    check_size(path, width.into(), height.into())?;
    // Before the limits of the picture, which are too small for the profile of a small one; decoders have others until then.
    let profile = decoder.icc_profile().unwrap_or_default();
    let exif = if kind == "JPEG" { decoder.exif_metadata().unwrap_or_default() } else { None };
    // The size bounds the picture; what decoders need meanwhile is bounded by several times that.
    let mut limits = Limits::no_limits();
    let most = decoder.total_bytes().saturating_mul(4).saturating_add(LEAST);
    limits.max_alloc = Some(most);
    decoder.set_limits(limits).map_err(|e| refused(path, kind, &e))?;
    let orientation = decoder.orientation().map_err(|e| refused(path, kind, &e))?;
    let is_grey = !decoder.color_type().has_color();
    let of_inks = colours::of_inks(kind, bytes, profile.as_deref(), most);
    let is_converted = of_inks.is_some();
    let mut decoded = match of_inks {
        Some(converted) => converted,
        None => DynamicImage::from_decoder(decoder).map_err(|e| refused(path, kind, &e))?,
    };
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
    let mut pixels = Pixels::new(width, height, channels, samples)
        .ok_or_else(|| Error::malformed(path, kind, "it does not hold as many pixels as it says"))?;
    let meaning =
        colours::meant((kind, bytes), profile, &mut pixels, (is_grey, is_converted), exif.as_deref());
    Ok(Source::alone(pixels, meaning))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pixels::Precision;

    /// A TIFF or BigTIFF file of floats (red, green, blue, alpha), all of them 0.
    fn tiff(is_big: bool, size: u32) -> Vec<u8> {
        let word = if is_big { 8 } else { 4 };
        let mut bytes = b"II".to_vec();
        let mut put = |value: u64, length: usize| bytes.extend(&value.to_le_bytes()[..length]);
        if is_big {
            put(43 | 8 << 16, 6);
        } else {
            put(42, 2);
        }
        let start = if is_big { 16 } else { 8 };
        put(start, word);
        let (short, long) = (3, 4);
        let entries = 11;
        let head = start + if is_big { 8 + entries * 20 + 8 } else { 2 + entries * 12 + 4 };
        let data = u64::from(size) * u64::from(size) * 16;
        // Four numbers do not fit into an entry of the smaller kind.
        let list = |number: u64, place: u64| match is_big {
            true => (short, 4, number * 0x0001_0001_0001_0001),
            false => (short, 4, place),
        };
        put(entries, if is_big { 8 } else { 2 });
        for (tag, (kind, count, value)) in [
            (256, (long, 1, size.into())),
            (257, (long, 1, size.into())),
            (258, list(32, head)),
            (259, (short, 1, 1)),
            (262, (short, 1, 2)),
            (273, (long, 1, head + 16)),
            (277, (short, 1, 4)),
            (278, (long, 1, size.into())),
            (279, (long, 1, data)),
            (338, (short, 1, 1)),
            (339, list(3, head + 8)),
        ] {
            put(tag, 2);
            put(kind, 2);
            put(count, word);
            put(value, word);
        }
        put(0, word);
        for number in [32, 3] {
            put(number * 0x0001_0001_0001_0001, 8);
        }
        bytes.resize(bytes.len() + data as usize, 0);
        bytes
    }

    #[test]
    fn large_and_big_tiff_files_are_read() {
        // More than 256 MiB of pixels.
        for (is_big, size) in [(false, 3), (true, 3), (true, 4128)] {
            let source = decode(Path::new("a.tif"), &tiff(is_big, size)).unwrap();
            let pixels = &source.pictures[0].pixels;
            assert_eq!((pixels.width(), pixels.channels(), pixels.precision()), (size, 4, Precision::F32));
        }
    }

    #[test]
    fn what_is_not_read_is_not_called_damaged() {
        let mut bytes = tiff(false, 3);
        // Photometric interpretation 8, which is CIE L*a*b*.
        let lab = bytes.windows(4).position(|b| b == [6, 1, 3, 0]).unwrap();
        bytes[lab + 8] = 8;
        let error = decode(Path::new("a.tif"), &bytes).unwrap_err().to_string();
        assert!(error.contains("of a kind that is not read") && !error.contains("damaged"), "{error}");
        bytes.truncate(60);
        assert!(decode(Path::new("a.tif"), &bytes).unwrap_err().to_string().contains("is damaged"));
    }
}
