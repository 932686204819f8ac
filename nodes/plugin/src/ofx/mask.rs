//! Masks: where an effect shows, by a picture of a clip of its own.

use super::frame::Frame;
use super::host::Outcome;
use super::image::Fetched;
use isophote::engine::Rect;
use std::ffi::CStr;

/// Part of a mask's pixels that counts, in the order of [`MASK_OPTIONS`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MaskFrom {
    /// Alpha; the first channel of a picture that has no alpha.
    #[default]
    Alpha,
    /// Luminance of the colours as they are stored.
    Luminance,
    Red,
    Green,
    Blue,
}

/// Projects store positions in this list.
pub const MASK_OPTIONS: [&CStr; 5] = [c"Alpha", c"Luminance", c"Red", c"Green", c"Blue"];

/// Shares of red, green and blue in luminance (ITU-R BT.709).
const LUMINANCE: [f32; 3] = [0.2126, 0.7152, 0.0722];

/// Rule by which a mask is read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MaskRule {
    /// Part that counts.
    pub from: MaskFrom,
    /// True where the effect shows where the mask does not.
    pub inverted: bool,
}

impl MaskFrom {
    /// The choice at a position.
    pub fn at(index: usize) -> Option<Self> {
        [Self::Alpha, Self::Luminance, Self::Red, Self::Green, Self::Blue].get(index).copied()
    }

    /// Amount that a pixel stands for; `has_alpha` says whether its alpha is the picture's own.
    fn amount(self, [r, g, b, a]: [f32; 4], has_alpha: bool) -> f32 {
        match self {
            Self::Alpha if has_alpha => a,
            Self::Alpha | Self::Red => r,
            Self::Luminance => r * LUMINANCE[0] + g * LUMINANCE[1] + b * LUMINANCE[2],
            Self::Green => g,
            Self::Blue => b,
        }
    }
}

impl MaskRule {
    /// Amounts of the effect in the pixels of `window`, 0..=1; what is no number is 0.
    ///
    /// # Errors
    /// Memory; image format, when no image can have the mask's shape.
    pub fn read(self, mask: &Fetched<'_>, frame: &Frame, window: Rect) -> Outcome<Vec<f32>> {
        let has_alpha = mask.channels == 4;
        let mut amounts = mask.read_amounts(frame, window, |pixel| self.from.amount(pixel, has_alpha))?;
        for amount in &mut amounts {
            let share = if amount.is_nan() { 0.0 } else { amount.clamp(0.0, 1.0) };
            *amount = if self.inverted { 1.0 - share } else { share };
        }
        Ok(amounts)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_is_a_choice_for_every_option() {
        assert!((0..MASK_OPTIONS.len()).all(|index| MaskFrom::at(index).is_some()));
        assert_eq!((MaskFrom::at(0), MaskFrom::at(MASK_OPTIONS.len())), (Some(MaskFrom::default()), None));
    }

    #[test]
    fn every_part_of_a_pixel_is_its_own() {
        let pixel = [0.1, 0.2, 0.4, 0.8];
        let amounts = (0..5).filter_map(MaskFrom::at).map(|from| from.amount(pixel, true));
        let amounts: Vec<f32> = amounts.collect();
        assert_eq!([amounts[0], amounts[2], amounts[3], amounts[4]], [0.8, 0.1, 0.2, 0.4]);
        assert!((amounts[1] - 0.193_18).abs() < 1e-6);
        assert_eq!(MaskFrom::Alpha.amount(pixel, false), 0.1);
    }
}
