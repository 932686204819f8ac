//! Meaning of the numbers of PNG, JPEG, TIFF and WebP files, as profiles and chunks of PNG give it.

use image::DynamicImage;

use crate::meaning::{Alpha, Meaning};
use crate::pixels::{Pixels, Precision, Samples};
use crate::space::Space;
use crate::{exif, icc, inks, png, tiff};

/// Colours of inks through their profile; nothing for pictures of other colours, and without a profile that is understood.
pub fn of_inks(kind: &str, bytes: &[u8], profile: Option<&[u8]>, most: u64) -> Option<DynamicImage> {
    let profile = profile.filter(|_| inks::are_in(kind, bytes))?;
    let most = usize::try_from(most).unwrap_or(usize::MAX);
    let pixels = icc::of_inks(profile, &inks::read(kind, bytes, most)?)?;
    let (width, height) = (pixels.width(), pixels.height());
    match pixels.into_samples() {
        Samples::U8(samples) => image::RgbImage::from_raw(width, height, samples).map(Into::into),
        Samples::U16(samples) => {
            image::ImageBuffer::from_raw(width, height, samples).map(DynamicImage::ImageRgb16)
        }
        Samples::F16(_) | Samples::F32(_) => None,
    }
}

/// Meaning of a file's numbers, of a kind of file whose first bytes tell it. `is_grey` says that it has no colours, and
/// `is_converted` that its inks became sRGB. Pictures that only tables of a profile explain become sRGB here.
pub fn meant(
    (kind, bytes): (&str, &[u8]),
    profile: Option<Vec<u8>>,
    pixels: &mut Pixels,
    (is_grey, is_converted): (bool, bool),
    exif: Option<&[u8]>,
) -> Meaning {
    let mut meaning = match pixels.precision() {
        Precision::F16 | Precision::F32 => Meaning::light(),
        Precision::U8 | Precision::U16 => Meaning::display(),
    };
    if pixels.channels() < 4 {
        meaning.alpha = Alpha::None;
    }
    if is_converted {
        return Meaning { said_by: Some(icc::NAME), ..meaning };
    }
    if inks::are_in(kind, bytes) {
        let problem = "its inks (CMYK) have no ICC profile that is understood; their colours are guessed";
        meaning.warnings.push(problem.to_owned());
        return meaning;
    }
    let mut counts = true;
    if kind == "PNG" {
        (meaning, counts) = png::meant(bytes, meaning, profile.is_some());
    }
    match profile.filter(|_| counts) {
        Some(profile) => icc::meant(meaning, profile, pixels, is_grey),
        None if kind == "TIFF" => match tiff::primaries(bytes) {
            Some(primaries) => Meaning { primaries, said_by: Some("PrimaryChromaticities"), ..meaning },
            None => meaning,
        },
        None if exif.is_some_and(exif::is_adobe_rgb) => {
            Meaning { said_by: Some(exif::NAME), ..meaning.named(Some(Space::AdobeRgb)) }
        }
        None => meaning,
    }
}
