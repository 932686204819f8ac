//! A picture in main memory as the library takes it, with everything that `apply` would hand over beside it.

use std::sync::Arc;

use isophote_files::error::{Error, Result};
use isophote_files::limits;
use isophote_finishing::apply::picture_request::PictureRequest;
use isophote_loader::abi::{ISOPHOTE_ALPHA_EMISSIVE, ISOPHOTE_GUIDE_MASK, IsophoteRequest};
use isophote_pictures::exr::Guide;
use isophote_pictures::pixels::{Pixels, Precision};
use isophote_pictures::read::Source;
use isophote_pictures::space::Space;
use isophote_pictures::working::WorkingSpace;

/// Number that an infinity becomes when the library reads it.
const LARGEST_HALF: f32 = 65504.0;

/// A frame, or a picture by itself. The same bits as those that the library makes of what `apply` hands over.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// Its number in a sequence or a video.
    pub number: Option<i64>,
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Pixels across and down of the picture in its file, whose pixels need not be square.
    pub file_size: (u32, u32),
    /// Red, green, blue and alpha, rows from the top. Colour is multiplied by alpha where the picture is scene-referred, and
    /// is apart from it where it is display-referred: multiplied and divided again it would not be the same.
    pub color: Arc<Vec<[f32; 4]>>,
    /// Properties of the picture that the request names.
    pub request: PictureRequest,
    /// True where colour has light where alpha is 0 or little, which is filtered by itself.
    pub has_light: bool,
    /// Guides that the file holds beside colour, or that were painted over it.
    pub guides: Vec<Arc<GuideImage>>,
    /// The share of looks in each pixel, where that was painted.
    pub mask: Option<Arc<Vec<f32>>>,
    /// True where the file has these colours in 8 bits.
    pub is_bytes: bool,
    /// Samples of the colour that were NaN or infinite and were replaced.
    pub replaced: u64,
}

/// A guide over the pixels of its frame.
#[derive(Clone, Debug, PartialEq)]
pub struct GuideImage {
    /// The guide; its id names the graph's input.
    pub guide: Guide,
    /// Numbers a pixel: 4 of colours, and of normals and rest positions, of which the last is 0 where there is no surface, 2 of
    /// motion, which is no number where it is unknown, else 1.
    pub channels: u32,
    /// The numbers, rows from the top.
    pub data: Vec<f32>,
}

impl Frame {
    /// The first picture of a file. `space` says what its numbers mean where it is not the file that does.
    ///
    /// # Errors
    /// [`Error::Failure`] when memory is short, [`Error::Input`] for files without pictures.
    pub fn of(name: &str, mut source: Source, number: Option<i64>, space: Option<Space>) -> Result<Self> {
        let Some(picture) = source.pictures.first_mut() else {
            return Err(Error::input(name, "has no picture", "name another file"));
        };
        let size = u64::from(picture.pixels.width()) * u64::from(picture.pixels.height());
        limits::must_have(size * (16 + picture.guides.len() as u64 * 16), name)?;
        let guides = std::mem::take(&mut picture.guides);
        let working = WorkingSpace::of(space, picture);
        let changed = working.there.as_ref().map(|there| there.apply(&picture.pixels));
        let (pixels, bad) = changed.as_ref().map_or((&picture.pixels, 0), |(pixels, bad)| (pixels, *bad));
        let (color, replaced) = colors(pixels);
        let named = guides.into_iter().filter_map(|(name, pixels)| {
            let guide = Guide::ALL.into_iter().find(|guide| guide.id() == name)?;
            let there = working.there.as_ref().filter(|_| guide.is_colour());
            let pixels = match there {
                Some(there) => there.apply(&pixels).0,
                None => pixels,
            };
            Some(Arc::new(GuideImage { guide, channels: pixels.channels(), data: pixels.to_f32() }))
        });
        Ok(Self {
            number,
            width: pixels.width(),
            height: pixels.height(),
            file_size: picture.own.map_or((pixels.width(), pixels.height()), |own| own.size),
            has_light: picture.meaning.is_premultiplied() && color.iter().any(is_beyond_coverage),
            request: PictureRequest::of(picture, working.space, number),
            guides: named.collect(),
            mask: None,
            is_bytes: changed.is_none() && picture.pixels.precision() == Precision::U8,
            replaced: replaced + bad,
            color: Arc::new(color),
        })
    }

    /// True where colour is multiplied by alpha.
    pub fn is_premultiplied(&self) -> bool {
        self.request.is_premultiplied
    }

    /// Request of `apply` to the library for this frame, of its size and with the guides that are wanted.
    pub fn request(&self, usual: IsophoteRequest) -> IsophoteRequest {
        let request = self.request.request(usual);
        let alpha = if self.has_light { ISOPHOTE_ALPHA_EMISSIVE } else { request.alpha };
        IsophoteRequest { alpha, ..request }
    }

    /// Request of looks on a picture of so much of the size, with all of its guides, whichever frame it is.
    pub fn request_of_all(&self, scale: f32, usual: IsophoteRequest) -> IsophoteRequest {
        let mask = if self.mask.is_some() { ISOPHOTE_GUIDE_MASK } else { 0 };
        let guides = self.guides.iter().fold(mask, |all, image| all | image.guide.bit());
        let Self { width, height, .. } = *self;
        let scale = scale * self.request.scale;
        IsophoteRequest { width, height, scale, guides, frame: 0, ..self.request(usual) }
    }

    /// A guide, where the file has it.
    pub fn guide(&self, guide: Guide) -> Option<&GuideImage> {
        self.guides.iter().find(|image| image.guide == guide).map(|image| &**image)
    }

    /// The same pixels with maps that were painted over them: such as a control map, in the place of the file's own, and a mask.
    pub fn painted(
        &self,
        maps: impl IntoIterator<Item = Arc<GuideImage>>,
        mask: Option<Arc<Vec<f32>>>,
    ) -> Self {
        let mut guides = self.guides.clone();
        for map in maps {
            guides.retain(|image| image.guide != map.guide);
            guides.push(map);
        }
        Self { color: Arc::clone(&self.color), guides, mask, ..*self }
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> u64 {
        let guides: usize = self.guides.iter().map(|image| image.data.len() * size_of::<f32>()).sum();
        let mask = self.mask.as_ref().map_or(0, |mask| mask.len() * size_of::<f32>());
        (self.color.len() * size_of::<[f32; 4]>() + guides + mask) as u64
    }
}

/// Pixels as the library reads them: grey three times, opaque without alpha, 0 for what is no number and the largest half for
/// infinities, which are counted.
fn colors(pixels: &Pixels) -> (Vec<[f32; 4]>, u64) {
    let numbers = pixels.to_f32();
    let mut replaced = 0;
    let mut color: Vec<[f32; 4]> = match pixels.channels() {
        1 => numbers.iter().map(|v| [*v, *v, *v, 1.0]).collect(),
        3 => numbers.as_chunks::<3>().0.iter().map(|[r, g, b]| [*r, *g, *b, 1.0]).collect(),
        _ => numbers.as_chunks::<4>().0.to_vec(),
    };
    for value in color.as_flattened_mut().iter_mut().filter(|value| !value.is_finite()) {
        *value = if value.is_nan() { 0.0 } else { LARGEST_HALF.copysign(*value) };
        replaced += 1;
    }
    (color, replaced)
}

/// True where a premultiplied colour has more light than its coverage can explain, by the library's measure: more than
/// alpha / (1 - alpha)^4.
fn is_beyond_coverage(pixel: &[f32; 4]) -> bool {
    let [r, g, b, alpha] = *pixel;
    let alpha = alpha.clamp(0.0, 1.0);
    let share = (1.0 - alpha) * (1.0 - alpha);
    let most = alpha / (share * share).max(1e-30);
    [r, g, b].iter().any(|v| v.abs().min(LARGEST_HALF) > most)
}

#[cfg(test)]
mod tests {
    use super::*;
    use isophote_pictures::meaning::Meaning;
    use isophote_pictures::pixels::Samples;

    fn frame(meaning: Meaning, pixels: Pixels) -> Frame {
        Frame::of("a", Source::alone(pixels, meaning), None, None).unwrap()
    }

    #[test]
    fn pixels_are_what_the_library_reads() {
        let grey = frame(
            Meaning::light(),
            Pixels::new(2, 1, 1, Samples::F32(vec![f32::NAN, f32::NEG_INFINITY])).unwrap(),
        );
        assert_eq!(*grey.color, [[0.0, 0.0, 0.0, 1.0], [-65504.0, -65504.0, -65504.0, 1.0]]);
        let straight =
            frame(Meaning::display(), Pixels::new(1, 1, 4, Samples::U8(vec![255, 51, 0, 0])).unwrap());
        assert_eq!(*straight.color, [[1.0, 0.2, 0.0, 0.0]]);
        assert!(!straight.is_premultiplied() && !straight.has_light, "apart from alpha it is no light");
        assert!(straight.is_bytes && !grey.is_bytes);
    }

    #[test]
    fn light_beyond_coverage_is_found() {
        let light = |pixel: [f32; 4]| {
            frame(Meaning::light(), Pixels::new(1, 1, 4, Samples::F32(pixel.to_vec())).unwrap()).has_light
        };
        assert!(light([0.1, 0.0, 0.0, 0.0]) && light([9.0, 0.0, 0.0, 0.5]));
        assert!(!light([7.9, 7.9, 7.9, 0.5]) && !light([0.0; 4]) && !light([60000.0, 0.0, 0.0, 1.0]));
    }
}
