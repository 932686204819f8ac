//! TIFF files: tags that decoders keep to themselves, and files of 32-bit unsigned integers, which the decoder of others takes for
//! floats: read as 16 bits, with which they look the same.

use std::io::Cursor;

use crate::primaries::{Change, Chromaticities, REC709};
use image::error::{DecodingError, LimitError, LimitErrorKind};
use image::metadata::Orientation;
use image::{ColorType, ImageDecoder, ImageError, ImageFormat, ImageResult};
use tiff::decoder::ifd::Value;
use tiff::decoder::{Decoder, DecodingResult, Limits};
use tiff::tags::Tag;
use tiff::{ColorType as TiffColor, TiffError};

use crate::tiff_write::{ASSOCIATED, UNASSOCIATED};

/// The number of unsigned integers among sample formats.
const UNSIGNED: u16 = 1;

/// Tags of x and y of white, and of red, green and blue.
const WHITE_POINT: u16 = 318;
const PRIMARY_CHROMATICITIES: u16 = 319;

/// Meaning of a fourth sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fourth {
    /// Alpha that colour is multiplied by.
    Associated,
    /// Alpha apart from colour.
    Unassociated,
    /// Something else than alpha.
    Other,
}

/// Tags of a file that decoders keep to themselves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Said {
    /// `ExtraSamples`; nothing where the file has no such samples, or does not say which.
    pub fourth: Option<Fourth>,
    /// Width of a pixel over its height, where resolutions differ.
    pub pixel_aspect: Option<f32>,
}

/// Tags of a file; none of what is damaged.
pub fn said(bytes: &[u8]) -> Said {
    let Ok(mut decoder) = Decoder::new(Cursor::new(bytes)) else { return Said::default() };
    let extra = decoder.find_tag_unsigned_vec::<u16>(Tag::ExtraSamples).ok().flatten();
    let fourth = extra.and_then(|kinds| kinds.first().copied()).map(|kind| match kind {
        ASSOCIATED => Fourth::Associated,
        UNASSOCIATED => Fourth::Unassociated,
        _ => Fourth::Other,
    });
    let mut resolution = |tag| match decoder.find_tag(tag).ok().flatten()? {
        Value::Rational(n, d) if n > 0 && d > 0 => Some(f64::from(n) / f64::from(d)),
        _ => None,
    };
    let both = resolution(Tag::XResolution).zip(resolution(Tag::YResolution));
    let aspect = both.map(|(across, down)| (down / across) as f32);
    Said { fourth, pixel_aspect: aspect.filter(|aspect| (0.01..=100.0).contains(aspect) && *aspect != 1.0) }
}

/// A decoder of such a file that has read what it says of itself.
pub struct Wide<'a> {
    bytes: &'a [u8],
    inner: Decoder<Cursor<&'a [u8]>>,
    size: (u32, u32),
    color: ColorType,
}

impl<'a> Wide<'a> {
    /// The decoder; nothing for files of another kind, and for damaged ones.
    pub fn new(bytes: &'a [u8]) -> Option<Self> {
        let mut inner = Decoder::new(Cursor::new(bytes)).ok()?;
        let color = match inner.colortype().ok()? {
            TiffColor::Gray(32) => ColorType::L16,
            TiffColor::GrayA(32) => ColorType::La16,
            TiffColor::RGB(32) => ColorType::Rgb16,
            TiffColor::RGBA(32) => ColorType::Rgba16,
            _ => return None,
        };
        // Unsigned ones need not be said to be so.
        let formats = inner.find_tag_unsigned_vec::<u16>(Tag::SampleFormat).ok()?.unwrap_or_default();
        let size = inner.dimensions().ok()?;
        formats.iter().all(|format| *format == UNSIGNED).then_some(Self { bytes, inner, size, color })
    }
}

impl ImageDecoder for Wide<'_> {
    fn dimensions(&self) -> (u32, u32) {
        self.size
    }

    fn color_type(&self) -> ColorType {
        self.color
    }

    fn icc_profile(&mut self) -> ImageResult<Option<Vec<u8>>> {
        Ok(self.inner.get_tag_u8_vec(Tag::IccProfile).ok())
    }

    fn orientation(&mut self) -> ImageResult<Orientation> {
        let found = self.inner.find_tag_unsigned::<u8>(Tag::Orientation).ok().flatten();
        Ok(found.and_then(Orientation::from_exif).unwrap_or(Orientation::NoTransforms))
    }

    fn set_limits(&mut self, limits: image::Limits) -> ImageResult<()> {
        let most = limits.max_alloc.map_or(usize::MAX, |most| usize::try_from(most).unwrap_or(usize::MAX));
        let mut own = Limits::default();
        own.decoding_buffer_size = most;
        own.intermediate_buffer_size = most;
        own.ifd_value_size = most;
        let again = Decoder::new(Cursor::new(self.bytes)).map_err(failed)?;
        self.inner = again.with_limits(own);
        Ok(())
    }

    fn read_image(mut self, buffer: &mut [u8]) -> ImageResult<()> {
        let mut decoded = DecodingResult::U32(Vec::new());
        let layout = self.inner.read_image_to_buffer(&mut decoded).map_err(failed)?;
        let DecodingResult::U32(samples) = decoded else {
            return Err(failed(TiffError::IntSizeError));
        };
        let channels = usize::from(self.color.channel_count());
        let pixels = buffer.len() / 2 / channels;
        if samples.len() < pixels * channels {
            return Err(ImageError::Limits(LimitError::from_kind(LimitErrorKind::InsufficientMemory)));
        }
        let samples = interleaved(samples, layout.planes > 1, channels);
        for (to, sample) in buffer.as_chunks_mut::<2>().0.iter_mut().zip(samples) {
            *to = narrow(sample).to_ne_bytes();
        }
        Ok(())
    }

    fn read_image_boxed(self: Box<Self>, buffer: &mut [u8]) -> ImageResult<()> {
        (*self).read_image(buffer)
    }
}

/// Primaries that tags of a file name, white apart from the others; nothing without, and where they span no colours.
pub fn primaries(bytes: &[u8]) -> Option<Chromaticities> {
    let mut decoder = Decoder::new(Cursor::new(bytes)).ok()?;
    let mut numbers = |tag| -> Option<Vec<f32>> {
        let Value::List(list) = decoder.find_tag(Tag::Unknown(tag)).ok()?? else { return None };
        let number = |value: &Value| match value {
            Value::Rational(above, below) => Some(*above as f32 / *below as f32),
            _ => None,
        };
        list.iter().map(number).collect()
    };
    let (white, others) = (numbers(WHITE_POINT)?, numbers(PRIMARY_CHROMATICITIES)?);
    let found = [others, white].concat().try_into().ok()?;
    Change::new(found, REC709).map(|_| found)
}

/// Samples pixel by pixel: planes follow each other where they are apart.
pub fn interleaved<T: Copy>(samples: Vec<T>, is_planar: bool, channels: usize) -> Vec<T> {
    if !is_planar {
        return samples;
    }
    let pixels = samples.len() / channels;
    (0..pixels * channels).map(|at| samples[at % channels * pixels + at / channels]).collect()
}

/// The nearest number of 16 bits for the same share of the range.
fn narrow(wide: u32) -> u16 {
    let (most, half) = (u64::from(u32::MAX), u64::from(u32::MAX / 2));
    // At most 65535.
    ((u64::from(wide) * u64::from(u16::MAX) + half) / most) as u16
}

fn failed(problem: TiffError) -> ImageError {
    match problem {
        TiffError::LimitsExceeded => {
            ImageError::Limits(LimitError::from_kind(LimitErrorKind::InsufficientMemory))
        }
        problem => ImageError::Decoding(DecodingError::new(ImageFormat::Tiff.into(), problem)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_of_the_range_are_kept() {
        for (wide, narrowed) in [(0, 0), (u32::MAX, u16::MAX), (0x8080_8080, 0x8080), (65536, 1)] {
            assert_eq!(narrow(wide), narrowed);
        }
    }
    #[test]
    fn primaries_are_those_of_the_tags() {
        use tiff::encoder::{Rational, TiffEncoder, colortype::RGB8};
        let file = |numbers: [u32; 8]| {
            let mut bytes = Cursor::new(Vec::new());
            let mut encoder = TiffEncoder::new(&mut bytes).unwrap();
            let mut image = encoder.new_image::<RGB8>(1, 1).unwrap();
            let values = numbers.map(|n| Rational { n, d: 10_000 });
            image.encoder().write_tag(Tag::Unknown(WHITE_POINT), &values[6..]).unwrap();
            image.encoder().write_tag(Tag::Unknown(PRIMARY_CHROMATICITIES), &values[..6]).unwrap();
            image.write_data(&[1, 2, 3]).unwrap();
            bytes.into_inner()
        };
        let p3 = primaries(&file([6800, 3200, 2650, 6900, 1500, 600, 3127, 3290])).unwrap();
        assert!(crate::primaries::same(p3, crate::primaries::P3), "{p3:?}");
        assert_eq!(primaries(&file([0; 8])), None);
    }
}
