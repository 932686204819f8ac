//! Memory that a picture takes from being decoded to being written, told by what its file says of itself.

use image::metadata::Orientation;
use image::{ColorType, ImageDecoder};

use crate::exr::Picture;
use crate::pixels::{Pixels, Samples};
use crate::working::WorkingSpace;
use crate::{colours, inks, said};

/// Bytes of all copies of the pixels of a file that is no EXR file, about. `keeps_samples` says that nothing asks for other
/// samples in the result.
pub fn of_decoded(kind: &str, bytes: &[u8], mut decoder: impl ImageDecoder, keeps_samples: bool) -> u64 {
    let (width, height) = decoder.dimensions();
    let pixels = u64::from(width) * u64::from(height);
    let channels = if decoder.color_type().has_alpha() { 4 } else { 3 };
    // As it is decoded, and as it is turned where a camera was.
    let is_turned = decoder.orientation().is_ok_and(|attitude| attitude != Orientation::NoTransforms);
    let decoded = decoder.total_bytes().saturating_mul(if is_turned { 2 } else { 1 });
    let sample = if keeps_samples { kept_sample(kind, bytes, decoder) } else { None };
    // The result while it is collected and handed on; else floats before, between and after changes of colour space.
    let beside = sample.map_or(4 * 4 * 3, |sample| 2 * sample * channels);
    decoded.saturating_add(pixels.saturating_mul(beside))
}

/// Bytes of a sample of a file whose numbers are filtered as they are; nothing where they are changed to others first.
fn kept_sample(kind: &str, bytes: &[u8], mut decoder: impl ImageDecoder) -> Option<u64> {
    // One pixel tells what becomes of all.
    const PIXEL: [u8; 4] = [200, 90, 30, 255];
    let (channels, is_wide) = match decoder.color_type() {
        ColorType::L8 => (1, false),
        ColorType::Rgb8 => (3, false),
        ColorType::La8 | ColorType::Rgba8 => (4, false),
        ColorType::L16 => (1, true),
        ColorType::Rgb16 => (3, true),
        ColorType::La16 | ColorType::Rgba16 => (4, true),
        _ => return None,
    };
    let pixel = PIXEL[..channels].iter();
    let samples = match is_wide {
        true => Samples::U16(pixel.map(|value| u16::from(*value) * 257).collect()),
        false => Samples::U8(pixel.copied().collect()),
    };
    let mut pixels = Pixels::new(1, 1, channels as u32, samples)?;
    let before = pixels.clone();
    let exif = if kind == "JPEG" { decoder.exif_metadata().unwrap_or_default() } else { None };
    let profile = decoder.icc_profile().unwrap_or_default();
    let is_grey = !decoder.color_type().has_color();
    let meaning = colours::meant((kind, bytes), profile, &mut pixels, (is_grey, false), exif.as_deref());
    let is_kept = pixels == before && !inks::are_in(kind, bytes);
    let mut picture = Picture::alone(pixels, meaning);
    said::add(kind, bytes, &mut picture);
    (is_kept && WorkingSpace::of(None, &picture).there.is_none()).then_some(1 + u64::from(is_wide))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::icc;
    use crate::meaning::Meaning;
    use crate::primaries::P3;
    use image::codecs::png::{PngDecoder, PngEncoder};
    use image::{ExtendedColorType, ImageEncoder};
    use std::io::Cursor;

    fn weight(profile: Option<&[u8]>, keeps_samples: bool) -> u64 {
        let mut file = Vec::new();
        let mut encoder = PngEncoder::new(&mut file);
        if let Some(profile) = profile {
            encoder.set_icc_profile(profile.to_vec()).unwrap();
        }
        encoder.write_image(&[9; 8 * 4 * 3], 8, 4, ExtendedColorType::Rgb8).unwrap();
        of_decoded("PNG", &file, PngDecoder::new(Cursor::new(&file)).unwrap(), keeps_samples)
    }

    #[test]
    fn bytes_stay_bytes_unless_colours_change() {
        let pixels = 8 * 4;
        assert_eq!(weight(None, true), pixels * 3 * 3);
        assert_eq!(weight(None, false), pixels * (3 + 48));
        let profile = |meaning: &Meaning| icc::made(meaning).unwrap();
        let wide = Meaning { primaries: P3, ..Meaning::display() };
        assert_eq!(weight(Some(&profile(&Meaning::display())), true), pixels * 3 * 3);
        assert_eq!(weight(Some(&profile(&wide)), true), pixels * (3 + 48));
    }
}
