//! TIFF files as they are written: with the kind of alpha (`ExtraSamples`), the profile and the shape of pixels, of which the
//! encoder of others says nothing.

use std::io::{Seek, Write};

use tiff::TiffError;
use tiff::encoder::colortype::{
    ColorType, Gray8, Gray16, RGB8, RGB16, RGB32Float, RGBA8, RGBA16, RGBA32Float,
};
use tiff::encoder::{Rational, TiffEncoder, TiffValue};
use tiff::tags::Tag;

use crate::display::densities;
use crate::meaning::Meaning;
use crate::pixels::{Pixels, Samples};

/// Number of `ExtraSamples` for alpha that colour is multiplied by.
pub const ASSOCIATED: u16 = 1;
/// The same for alpha apart from colour.
pub const UNASSOCIATED: u16 = 2;

/// Writes a picture of 8 or 16 bits, or of single floats of three or four channels.
///
/// # Errors
/// The reason as text.
pub fn write(
    file: &mut (impl Write + Seek),
    pixels: &Pixels,
    meaning: &Meaning,
    profile: Option<&[u8]>,
) -> Result<(), String> {
    let tags = Tags { size: (pixels.width(), pixels.height()), meaning, profile };
    let written = match (pixels.samples(), pixels.channels()) {
        (Samples::U8(v), 1) => tags.encode::<Gray8>(file, v),
        (Samples::U8(v), 3) => tags.encode::<RGB8>(file, v),
        (Samples::U8(v), 4) => tags.encode::<RGBA8>(file, v),
        (Samples::U16(v), 1) => tags.encode::<Gray16>(file, v),
        (Samples::U16(v), 3) => tags.encode::<RGB16>(file, v),
        (Samples::U16(v), 4) => tags.encode::<RGBA16>(file, v),
        (Samples::F32(v), 3) => tags.encode::<RGB32Float>(file, v),
        (Samples::F32(v), 4) => tags.encode::<RGBA32Float>(file, v),
        (samples, channels) => {
            return Err(format!("{} samples of {channels} channels are not written as TIFF", samples.len()));
        }
    };
    written.map_err(|e| e.to_string())
}

/// Everything but the pixels.
struct Tags<'a> {
    size: (u32, u32),
    meaning: &'a Meaning,
    profile: Option<&'a [u8]>,
}

impl Tags<'_> {
    fn encode<C: ColorType>(
        &self,
        file: &mut (impl Write + Seek),
        samples: &[C::Inner],
    ) -> Result<(), TiffError>
    where
        [C::Inner]: TiffValue,
    {
        let mut encoder = TiffEncoder::new(file)?;
        let mut image = encoder.new_image::<C>(self.size.0, self.size.1)?;
        if C::BITS_PER_SAMPLE.len() == 4 {
            let kind = if self.meaning.is_premultiplied() { ASSOCIATED } else { UNASSOCIATED };
            image.encoder().write_tag(Tag::ExtraSamples, kind)?;
        }
        if let Some(profile) = self.profile {
            image.encoder().write_tag(Tag::IccProfile, profile)?;
        }
        if self.meaning.pixel_aspect != 1.0 {
            let [across, down] = densities(self.meaning.pixel_aspect);
            image.x_resolution(Rational { n: across, d: 1 });
            image.y_resolution(Rational { n: down, d: 1 });
        }
        image.write_data(samples)
    }
}
