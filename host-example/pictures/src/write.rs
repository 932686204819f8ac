//! Results to files, as the extension says.

use std::io::Write;
use std::path::Path;

use image::codecs::jpeg::{PixelDensity, PixelDensityUnit};
use image::{ExtendedColorType, ImageEncoder, ImageResult};

use crate::convert::Conversion;
use crate::exr::{ExrFile, components};
use crate::floats;
use crate::meaning::{Alpha, ImageState, Meaning};
use crate::pixels::{Pixels, Precision, Samples};
use crate::primaries::REC709;
use crate::read::Source;
use crate::resize::{self, Resize};
use crate::space::Space;
use crate::transfer::Transfer;
use crate::{display, icc, png, svg, tiff_write};
use isophote_files::error::{Error, Result};
use isophote_files::files::{self, Existing};
use isophote_files::output;

/// Quality of JPEG files, 1 to 100.
const JPEG_QUALITY: u8 = 95;

/// Options of a file that is written; those that are not given are as the picture asks for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Options {
    /// Quality of JPEG files, 1 to 100.
    pub quality: Option<u8>,
    /// Precision of samples.
    pub depth: Option<Precision>,
    /// Size of the picture.
    pub resize: Option<Resize>,
}

/// A kind of file that can be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// 8 or 16 bit, with alpha.
    Png,
    /// 8 bit, without alpha.
    Jpeg,
    /// 8 or 16 bit, or floats of linear light where the picture was such, with alpha.
    Tiff,
    /// Half or float.
    Exr,
    /// Areas of one colour as curves.
    Svg,
}

impl Format {
    /// The format that the extension names.
    ///
    /// # Errors
    /// [`Error::Input`] for others.
    pub fn of(path: &Path) -> Result<Self> {
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default();
        match extension.to_ascii_lowercase().as_str() {
            "png" => Ok(Self::Png),
            "jpg" | "jpeg" => Ok(Self::Jpeg),
            "tif" | "tiff" => Ok(Self::Tiff),
            "exr" => Ok(Self::Exr),
            "svg" => Ok(Self::Svg),
            _ => Err(Error::file(
                path,
                "is not a kind of picture that is written",
                "name a .png, .jpg, .tif, .exr or .svg file",
            )),
        }
    }

    /// Precisions of samples that its files can have.
    pub const fn depths(self) -> &'static [Precision] {
        match self {
            Self::Png => &[Precision::U8, Precision::U16],
            Self::Jpeg | Self::Svg => &[Precision::U8],
            Self::Tiff => &[Precision::U8, Precision::U16, Precision::F32],
            Self::Exr => &[Precision::F16, Precision::F32],
        }
    }

    /// Makes sure that results can be in a space that somebody names for them.
    ///
    /// # Errors
    /// [`Error::Input`] for encoded ones in EXR files, which are of light, and for others than sRGB in SVG files.
    pub fn check_space(self, space: Option<Space>) -> Result<()> {
        if let Some(space) = space.filter(|space| self == Self::Svg && *space != Space::Srgb) {
            let problem = format!("{} is not what colours of SVG files are in", space.id());
            return Err(Error::input("--output-space", problem, "leave it out, or write a .png file"));
        }
        match space.filter(|space| self == Self::Exr && !space.is_linear()) {
            Some(space) => Err(Error::input(
                "--output-space",
                format!("{} is encoded, and EXR files are of light", space.id()),
                "name linear, acescg, aces2065-1, p3 or rec2020",
            )),
            None => Ok(()),
        }
    }

    /// State of its numbers when they come from a picture of another state.
    pub fn state(self, source: ImageState) -> ImageState {
        match self {
            Self::Png | Self::Jpeg | Self::Svg => ImageState::DisplayReferred,
            Self::Tiff => source,
            Self::Exr => ImageState::SceneReferred,
        }
    }

    /// Meaning of results that it can keep: PNG has alpha apart from colour, EXR colour that is multiplied by it.
    pub fn kept(self, meaning: Meaning) -> Meaning {
        let alpha = match (self, meaning.alpha) {
            (Self::Png | Self::Jpeg | Self::Svg, Alpha::Premultiplied) => Alpha::Straight,
            (Self::Exr, Alpha::Straight) => Alpha::Premultiplied,
            (_, alpha) => alpha,
        };
        Meaning { alpha, ..meaning }
    }
}

/// Writes the results of what `source` held, one for each of its pictures, whose numbers mean what `meaning` says.
/// All of them go into `exr`, an EXR file that they came from; of other files there is one picture.
///
/// # Errors
/// As [`files::write()`]; [`Error::Input`] for another size or precision of what goes into an EXR file beside what it has.
pub fn write(
    path: &Path,
    existing: Existing,
    (format, options): (Format, Options),
    mut results: Vec<Pixels>,
    meaning: &Meaning,
    source: &Source,
    exr: Option<ExrFile>,
) -> Result<()> {
    if let (Format::Exr, Some(mut exr)) = (format, exr) {
        options.check_in_place(path)?;
        for (at, result) in results.drain(..).enumerate() {
            exr.replace(at, &result)
                .map_err(|problem| Error::file(path, problem, "choose another picture"))?;
        }
        return files::write(path, existing, |file| exr.write(file));
    }
    let (Some(pixels), Some(picture)) = (results.into_iter().next(), source.pictures.first()) else {
        return Err(Error::file(path, "would be empty", "choose another picture"));
    };
    let pixels = display::shown(pixels, meaning);
    let pixels = options.sized(path, pixels, meaning)?;
    let of_depth = options.depth.and_then(|depth| meaning_at(format, depth, meaning));
    let converted = of_depth.as_ref().and_then(|to| Some(Conversion::between(meaning, to)?.apply(&pixels).0));
    let (pixels, meaning) = (converted.unwrap_or(pixels), of_depth.as_ref().unwrap_or(meaning));
    match format {
        Format::Exr => {
            let source = options.depth.unwrap_or(picture.pixels.precision());
            write_exr(path, existing, &pixels, (source, meaning))
        }
        Format::Png => {
            // A float result holds more than 8 bits can, and so does light of 8 bits.
            let is_wide = matches!(meaning.transfer, Transfer::Linear | Transfer::Pq | Transfer::Hlg);
            let precision = match picture.pixels.precision() {
                Precision::U8 if !is_wide || pixels.precision() == Precision::U8 => Precision::U8,
                _ => Precision::U16,
            };
            let pixels = pixels.converted(options.depth.unwrap_or(precision));
            files::write(path, existing, |file| {
                file.write_all(&png_file(&pixels, meaning)?).map_err(|e| e.to_string())
            })
        }
        Format::Tiff => {
            let precision = match (meaning.state, picture.pixels.precision()) {
                (ImageState::SceneReferred, _) => Precision::F32,
                (ImageState::DisplayReferred, Precision::U8) => Precision::U8,
                (ImageState::DisplayReferred, _) => Precision::U16,
            };
            let pixels = grey_as_rgb(pixels.converted(options.depth.unwrap_or(precision)));
            let profile = profile(meaning, pixels.channels());
            files::write(path, existing, |file| tiff_write::write(file, &pixels, meaning, profile.as_deref()))
        }
        Format::Svg => write_svg(path, existing, pixels, meaning),
        Format::Jpeg => {
            let quality = options.quality.unwrap_or(JPEG_QUALITY);
            write_jpeg(path, existing, opaque(path, pixels.converted(Precision::U8)), (quality, meaning))
        }
    }
}

fn write_svg(path: &Path, existing: Existing, pixels: Pixels, meaning: &Meaning) -> Result<()> {
    let srgb = Meaning { alpha: meaning.alpha, ..Meaning::display() };
    let converted = Conversion::between(meaning, &srgb).map(|there| there.apply(&pixels).0);
    let pixels = converted.unwrap_or(pixels).converted(Precision::U8);
    files::write(path, existing, |file| svg::write(file, &pixels, meaning.pixel_aspect))
}

fn write_jpeg(
    path: &Path,
    existing: Existing,
    pixels: Pixels,
    (quality, meaning): (u8, &Meaning),
) -> Result<()> {
    let color = color_type(&pixels);
    files::write(path, existing, |file| {
        let mut encoder = image::codecs::jpeg::JpegEncoder::new_with_quality(file, quality);
        let [across, down] = display::densities(meaning.pixel_aspect);
        let density = (across as u16, down as u16);
        encoder.set_pixel_density(PixelDensity { density, unit: PixelDensityUnit::PixelAspectRatio });
        say(&mut encoder, meaning, pixels.channels());
        as_text(encoder.write_image(pixels.bytes(), pixels.width(), pixels.height(), color))
    })
}

impl Options {
    /// Refuses what would change all that an EXR file has beside the result.
    fn check_in_place(self, path: &Path) -> Result<()> {
        let problem =
            "keeps the other layers of the EXR file, whose size and precision are those of the file";
        match (self.resize, self.depth) {
            (None, None) => Ok(()),
            _ => Err(Error::file(path, problem, "leave --resize and --depth out, or name a .tif file")),
        }
    }

    /// Pixels in the size that is asked for.
    ///
    /// # Errors
    /// [`Error::Input`] for one that has too many.
    pub fn sized(self, path: &Path, pixels: Pixels, meaning: &Meaning) -> Result<Pixels> {
        let Some(resize) = self.resize else { return Ok(pixels) };
        let size = resize
            .of((pixels.width(), pixels.height()))
            .map_err(|problem| Error::file(path, problem, "ask for a smaller size"))?;
        Ok(resize::resized(&pixels, size, meaning.is_premultiplied()))
    }
}

/// Meaning of numbers of a precision in TIFF files, where it is another: floats are of light, and integers of what displays show.
fn meaning_at(format: Format, depth: Precision, meaning: &Meaning) -> Option<Meaning> {
    let is_float = matches!(depth, Precision::F16 | Precision::F32);
    match (format, is_float, meaning.state) {
        (Format::Tiff, true, _) if meaning.transfer != Transfer::Linear => {
            Some(Meaning { transfer: Transfer::Linear, profile: None, ..meaning.clone() })
        }
        (Format::Tiff, false, ImageState::SceneReferred) => Some(Meaning::display()),
        _ => None,
    }
}

/// A PNG file with what it says of its numbers and of the shape of its pixels.
fn png_file(pixels: &Pixels, meaning: &Meaning) -> std::result::Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    let mut encoder = image::codecs::png::PngEncoder::new(&mut bytes);
    let channels = pixels.channels();
    let profile = match png::can_say(meaning) {
        true => meaning.profile_of(channels).map(<[u8]>::to_vec),
        false => profile(meaning, channels),
    };
    let is_said = profile.is_some_and(|profile| encoder.set_icc_profile(profile).is_ok());
    // PNG wants the larger byte first; the encoder takes the machine's order.
    as_text(encoder.write_image(pixels.bytes(), pixels.width(), pixels.height(), color_type(pixels)))?;
    let bytes = if is_said { bytes } else { png::with_meaning(bytes, meaning) };
    Ok(png::with_shape(bytes, meaning.pixel_aspect))
}

/// Floats of one channel as three equal ones: TIFF files of grey floats are not written.
fn grey_as_rgb(pixels: Pixels) -> Pixels {
    if pixels.precision() != Precision::F32 || pixels.channels() != 1 {
        return pixels;
    }
    let rgb = pixels.to_f32().into_iter().flat_map(|v| [v; 3]).collect();
    // Three samples for each that there was.
    Pixels::new(pixels.width(), pixels.height(), 3, Samples::F32(rgb)).unwrap_or(pixels)
}

/// EXR in the precision that the source deserves: 8 bits fit into halves, 16 do not.
fn write_exr(
    path: &Path,
    existing: Existing,
    pixels: &Pixels,
    (source, meaning): (Precision, &Meaning),
) -> Result<()> {
    let precision = match source {
        Precision::U8 | Precision::F16 => floats::Precision::Half,
        Precision::U16 | Precision::F32 => floats::Precision::Float,
    };
    // Numbers that somebody says to be encoded become light, which is what these files are of.
    let light = Meaning { transfer: Transfer::Linear, ..meaning.clone() };
    let changed = Conversion::between(meaning, &light).map(|change| change.apply(pixels).0);
    let pixels = changed.as_ref().unwrap_or(pixels);
    let channels = pixels.channels();
    let data = floats::Picture {
        width: pixels.width(),
        height: pixels.height(),
        channels: channels as usize,
        data: pixels.to_f32(),
    };
    let aspect = Some(meaning.pixel_aspect).filter(|aspect| *aspect != 1.0);
    let chromaticities = Some(meaning.primaries).filter(|_| !meaning.has_primaries(REC709));
    floats::save_exr(path, existing, &data, components(channels), precision, (chromaticities, aspect))
}

/// Adds a colour profile of what numbers mean.
fn say(encoder: &mut impl ImageEncoder, meaning: &Meaning, channels: u32) {
    if let Some(profile) = profile(meaning, channels) {
        // All encoders that are used keep profiles.
        let _ = encoder.set_icc_profile(profile);
    }
}

/// The colour profile that says what numbers mean: the one of the source where it is one of pictures with these channels, else one
/// that is made where the numbers are not what is assumed without.
fn profile(meaning: &Meaning, channels: u32) -> Option<Vec<u8>> {
    let made = || icc::made(meaning).filter(|_| !meaning.is_usual() && channels > 1);
    meaning.profile_of(channels).map(<[u8]>::to_vec).or_else(made)
}

fn as_text(result: ImageResult<()>) -> std::result::Result<(), String> {
    result.map_err(|e| e.to_string())
}

fn color_type(pixels: &Pixels) -> ExtendedColorType {
    match (pixels.precision(), pixels.channels()) {
        (Precision::U8, 1) => ExtendedColorType::L8,
        (Precision::U8, 3) => ExtendedColorType::Rgb8,
        (Precision::U8, _) => ExtendedColorType::Rgba8,
        (Precision::F32, 3) => ExtendedColorType::Rgb32F,
        (Precision::F32, _) => ExtendedColorType::Rgba32F,
        (_, 1) => ExtendedColorType::L16,
        (_, 3) => ExtendedColorType::Rgb16,
        (..) => ExtendedColorType::Rgba16,
    }
}

/// Without alpha, over white: JPEG has none.
fn opaque(path: &Path, pixels: Pixels) -> Pixels {
    let (Samples::U8(samples), 4) = (pixels.samples(), pixels.channels()) else { return pixels };
    if samples.iter().skip(3).step_by(4).any(|a| *a < 255) {
        output::warn(format_args!(
            "{}: JPEG keeps no transparency; the picture is put on white",
            path.display()
        ));
    }
    let over = |v: u8, a: u8| {
        let (v, a) = (u32::from(v), u32::from(a));
        ((v * a + 255 * (255 - a) + 127) / 255) as u8
    };
    let flat = samples
        .as_chunks::<4>()
        .0
        .iter()
        .flat_map(|[r, g, b, a]| [*r, *g, *b].map(|v| over(v, *a)))
        .collect();
    let (width, height) = (pixels.width(), pixels.height());
    // Three of four samples of every pixel are left.
    Pixels::new(width, height, 3, Samples::U8(flat)).unwrap_or(pixels)
}
