//! Working spaces: those in which pictures are filtered.

use crate::convert::Conversion;
use crate::exr::Picture;
use crate::meaning::{Alpha, ImageState, Meaning};
use crate::primaries::REC709;
use crate::space::Space;

/// The space in which a picture is filtered, and the change to it from what its numbers mean. The library knows three
/// spaces; others are changed here.
#[derive(Debug)]
pub struct WorkingSpace {
    /// The space of the request: sRGB, linear or ACEScg.
    pub space: Space,
    /// The change to it.
    pub there: Option<Conversion>,
    /// Meaning of the picture's numbers.
    source: Meaning,
    /// Meaning of numbers in the working space.
    working: Meaning,
}

impl WorkingSpace {
    /// Space for a picture whose numbers mean what `space` names, or what the file says without.
    pub fn of(space: Option<Space>, picture: &Picture) -> Self {
        let source = picture.meaning.clone().named(space);
        let is_grey = picture.pixels.channels() == 1;
        let primaries = if is_grey { REC709 } else { source.primaries };
        let space = Space::working_for(primaries, &source.transfer);
        let (primaries, transfer) = (space.primaries(), space.transfer());
        // Grey has the white of its file.
        let primaries = if is_grey { source.primaries } else { primaries };
        let working = Meaning { primaries, transfer, ..source.clone() };
        Self { space, there: Conversion::between(&source, &working), source, working }
    }

    /// The same for results that have alpha, where they do, whether or not the picture has.
    #[must_use]
    pub fn with_alpha(mut self, has_alpha: bool) -> Self {
        for meaning in [&mut self.source, &mut self.working].into_iter().filter(|_| has_alpha) {
            if meaning.alpha == Alpha::None {
                meaning.alpha =
                    if meaning.is_premultiplied() { Alpha::Premultiplied } else { Alpha::Straight };
            }
        }
        self
    }

    /// Meaning of results in files of a state, in the space that somebody names for them.
    pub fn of_results(&self, state: ImageState, space: Option<Space>) -> Meaning {
        self.source.of_results(state).named(space)
    }

    /// The change from it to another meaning.
    pub fn back(&self, to: &Meaning) -> Option<Conversion> {
        Conversion::between(&self.working, to)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pixels::{Pixels, Precision, Samples};
    use crate::primaries::P3;

    fn picture(meaning: Meaning, samples: Vec<u8>) -> Picture {
        Picture::alone(Pixels::new(samples.len() as u32 / 4, 1, 4, Samples::U8(samples)).unwrap(), meaning)
    }

    #[test]
    fn display_p3_is_filtered_as_light_and_comes_back_as_it_was() {
        let samples: Vec<u8> = (0..=255).flat_map(|v| [v, 255 - v, v / 2, v.max(1)]).collect();
        let meaning = Meaning { primaries: P3, ..Meaning::display() };
        let picture = picture(meaning, samples);
        let working = WorkingSpace::of(None, &picture);
        assert_eq!(working.space, Space::Linear);
        let (color, _) = working.there.as_ref().unwrap().apply(&picture.pixels);
        let same = working.of_results(ImageState::DisplayReferred, None);
        let back = working.back(&same).unwrap().apply(&color).0;
        assert_eq!(back.converted(Precision::U8), picture.pixels);
        // In an EXR file it is light of Rec.709, multiplied by alpha.
        let light = working.of_results(ImageState::SceneReferred, None);
        assert!(light.is_usual() && light.alpha == Alpha::Premultiplied);
        let multiplied = working.back(&light).unwrap().apply(&color).0.to_f32();
        let [first, .., alpha] = multiplied[4 * 200..][..4] else { panic!() };
        assert!((first - color.to_f32()[4 * 200] * alpha).abs() < 1e-6);
    }

    #[test]
    fn usual_numbers_are_not_touched() {
        let picture = picture(Meaning::display(), vec![1, 2, 3, 4]);
        for (named, space) in
            [(None, Space::Srgb), (Some(Space::Linear), Space::Linear), (Some(Space::Acescg), Space::Acescg)]
        {
            let working = WorkingSpace::of(named, &picture);
            assert_eq!((working.space, working.there), (space, None));
        }
    }
}
