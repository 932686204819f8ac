//! Changes of the numbers of pixels: transfer, primaries, and whether colour is multiplied by alpha.

use crate::primaries::{Change, Chromaticities, same};
use crate::space::Space;
use crate::transfer::Transfer;

/// Number that an infinity becomes.
const LARGEST_HALF: f32 = 65504.0;

/// Relation of numbers to colours.
#[derive(Clone, Debug, PartialEq)]
pub struct Encoding {
    /// Primaries and white.
    pub primaries: Chromaticities,
    /// Relation of numbers to light that is not multiplied by alpha.
    pub transfer: Transfer,
    /// True where colour is multiplied by alpha.
    pub is_premultiplied: bool,
}

impl Encoding {
    /// Numbers of a space.
    pub fn of(space: Space, is_premultiplied: bool) -> Self {
        Self { primaries: space.primaries(), transfer: space.transfer(), is_premultiplied }
    }

    fn has_same_numbers(&self, other: &Self) -> bool {
        self.transfer == other.transfer && self.is_premultiplied == other.is_premultiplied
    }
}

/// A change from one encoding to another.
#[derive(Clone, Debug, PartialEq)]
pub struct Conversion {
    from: Encoding,
    to: Encoding,
    change: Option<Change>,
}

impl Conversion {
    /// From one encoding to another; nothing where numbers stay as they are. Primaries that span no colours stay too.
    pub fn between(from: Encoding, to: Encoding) -> Option<Self> {
        let is_same = same(from.primaries, to.primaries);
        let change = if is_same { None } else { Change::new(from.primaries, to.primaries) };
        (change.is_some() || !from.has_same_numbers(&to)).then_some(Self { from, to, change })
    }

    /// From one space to another.
    pub fn of_spaces(from: Space, to: Space, is_premultiplied: bool) -> Option<Self> {
        Self::between(Encoding::of(from, is_premultiplied), Encoding::of(to, is_premultiplied))
    }

    /// Changes a pixel of grey, or of red, green and blue with or without alpha. The result says how many samples of colour
    /// that are no number or infinite were replaced first, as the library would, so that they do not spread to the other
    /// channels.
    pub fn apply(&self, pixel: &mut [f32]) -> u64 {
        let colors = if pixel.len() == 1 { 1 } else { 3 };
        let mut replaced = 0;
        for value in pixel.iter_mut().take(colors).filter(|v| !v.is_finite()) {
            *value = if value.is_nan() { 0.0 } else { LARGEST_HALF.copysign(*value) };
            replaced += 1;
        }
        match pixel {
            [grey] => {
                let [changed, ..] = self.to.transfer.encode(self.from.transfer.decode([*grey; 3]));
                *grey = changed;
            }
            [r, g, b, alpha @ ..] => {
                [*r, *g, *b] = self.color([*r, *g, *b], alpha.first().copied().unwrap_or(1.0));
            }
            _ => {}
        }
        replaced
    }

    fn color(&self, mut rgb: [f32; 3], alpha: f32) -> [f32; 3] {
        let is_linear = self.from.transfer == Transfer::Linear && self.to.transfer == Transfer::Linear;
        // Multiplied light needs no division where it stays such.
        let is_apart = !(is_linear && self.from.is_premultiplied && self.to.is_premultiplied);
        if is_apart && self.from.is_premultiplied && alpha > 0.0 {
            rgb = rgb.map(|v| v / alpha);
        }
        rgb = self.from.transfer.decode(rgb);
        if let Some(change) = &self.change {
            rgb = change.apply(rgb);
        }
        rgb = self.to.transfer.encode(rgb);
        // Light without coverage stays light.
        let is_light = self.from.is_premultiplied && alpha <= 0.0;
        if is_apart && self.to.is_premultiplied && !is_light {
            rgb = rgb.map(|v| v * alpha);
        }
        rgb
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_space_is_left_for_its_working_space_and_comes_back() {
        let colors = [[0.1, 0.5, 0.9], [0.0, 0.0, 0.0], [1.0, 1.0, 1.0], [0.7, 0.2, 0.4]];
        for space in Space::ALL {
            for is_premultiplied in [false, true] {
                let there = Conversion::of_spaces(space, space.working(), is_premultiplied);
                let back = Conversion::of_spaces(space.working(), space, is_premultiplied);
                assert_eq!(there.is_none(), space == space.working(), "{space:?}");
                let (Some(there), Some(back)) = (there, back) else { continue };
                for [r, g, b] in colors {
                    for alpha in [1.0, 0.3] {
                        let share = if is_premultiplied { alpha } else { 1.0 };
                        let given = [r * share, g * share, b * share, alpha];
                        let mut pixel = given;
                        assert_eq!(there.apply(&mut pixel) + back.apply(&mut pixel), 0);
                        let is_near = pixel.iter().zip(given).all(|(a, b)| (a - b).abs() < 5e-4);
                        assert!(is_near, "{space:?} {given:?} {pixel:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn curves_act_on_colour_that_is_not_multiplied_by_alpha() {
        let of = |is_premultiplied| {
            Conversion::of_spaces(Space::DisplayP3, Space::Linear, is_premultiplied).unwrap()
        };
        let mut straight = [0.6, 0.4, 0.2, 0.5];
        let mut multiplied = [0.3, 0.2, 0.1, 0.5];
        of(false).apply(&mut straight);
        of(true).apply(&mut multiplied);
        for (a, b) in straight[..3].iter().zip(&multiplied) {
            assert!((a * 0.5 - b).abs() < 1e-6, "{straight:?} {multiplied:?}");
        }
    }
}
