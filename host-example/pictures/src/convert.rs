//! Changes of what the numbers of pictures mean: transfer, primaries, kind of alpha.

use isophote_colour::Encoding;
use rayon::prelude::*;

use crate::meaning::Meaning;
use crate::pixels::{Pixels, Samples};

/// A change from one meaning to another.
#[derive(Clone, Debug, PartialEq)]
pub struct Conversion(isophote_colour::Conversion);

impl Conversion {
    /// From one meaning to another; nothing where numbers stay as they are. Primaries that span no colours stay too.
    pub fn between(from: &Meaning, to: &Meaning) -> Option<Self> {
        isophote_colour::Conversion::between(encoding(from), encoding(to)).map(Self)
    }

    /// The picture in the other meaning, and how many samples of colour that are no number or infinite were replaced first,
    /// as the library would, so that they do not spread to the other channels.
    pub fn apply(&self, pixels: &Pixels) -> (Pixels, u64) {
        let mut numbers = pixels.to_f32();
        let channels = pixels.channels() as usize;
        let replaced = numbers.par_chunks_exact_mut(channels).map(|pixel| self.0.apply(pixel)).sum();
        // As many numbers as there were.
        let changed = Pixels::new(pixels.width(), pixels.height(), pixels.channels(), Samples::F32(numbers));
        (changed.unwrap_or_else(|| pixels.clone()), replaced)
    }
}

/// Relation of a picture's numbers to colours.
fn encoding(meaning: &Meaning) -> Encoding {
    let Meaning { primaries, transfer, .. } = meaning.clone();
    Encoding { primaries, transfer, is_premultiplied: meaning.is_premultiplied() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::primaries::AP1;

    #[test]
    fn there_and_back_is_where_it_was() {
        let numbers: Vec<f32> =
            (0..8 * 4).map(|i| [0.0f32, 0.02, 0.5, 1.0][i % 4].max(0.01 * i as f32)).collect();
        let picture = Pixels::new(8, 1, 4, Samples::F32(numbers.clone())).unwrap();
        let (display, light) = (Meaning::display(), Meaning::light());
        let there = Conversion::between(&display, &light).unwrap();
        let back = Conversion::between(&light, &display).unwrap();
        let changed = there.apply(&picture).0;
        assert_ne!(changed, picture);
        for (a, b) in back.apply(&changed).0.to_f32().iter().zip(&numbers) {
            assert!((a - b).abs() < 1e-5, "{a} {b}");
        }
        assert_eq!(Conversion::between(&light, &light), None);
    }

    #[test]
    fn white_stays_white_and_primaries_widen() {
        let aces = Pixels::new(2, 1, 3, Samples::F32(vec![1.0, 1.0, 1.0, 0.0, 1.0, 0.0])).unwrap();
        let from = Meaning { primaries: AP1, ..Meaning::light() };
        let display = Conversion::between(&from, &Meaning::display()).unwrap().apply(&aces).0.to_f32();
        assert!(display[..3].iter().all(|v| (v - 1.0).abs() < 1e-6));
        assert!(display[3] < 0.0 && display[4] > 1.0);
    }

    #[test]
    fn bad_numbers_are_replaced_and_counted() {
        let bad = Pixels::new(1, 1, 4, Samples::F32(vec![f32::NAN, f32::INFINITY, 0.5, 1.0])).unwrap();
        let from = Meaning { primaries: AP1, ..Meaning::light() };
        let (changed, replaced) = Conversion::between(&from, &Meaning::light()).unwrap().apply(&bad);
        assert_eq!(replaced, 2);
        assert!(changed.to_f32().iter().all(|v| v.is_finite()));
    }
}
