//! The pixel under the pointer: where it is in the picture, and its values.

use super::viewport::Overlay;

/// Values of a pixel: red, green, blue and alpha, or the first few numbers of a layer.
pub type Pixel = [f32; 4];

/// A pixel as it was read from the device.
#[derive(Clone, Copy, Debug)]
pub struct Probed {
    /// Column and row, counted from the upper left corner of the picture.
    pub at: [u32; 2],
    /// Values of the original.
    pub original: Pixel,
    /// Values in the look, where there is one, or those of the layer that is shown instead.
    pub shown: Option<Pixel>,
    /// Layer that is shown instead of the look.
    pub overlay: Overlay,
}

impl PartialEq for Probed {
    fn eq(&self, other: &Self) -> bool {
        // Motion that is unknown is no number, and stays the same all the same.
        let bits = |pixel: Pixel| pixel.map(f32::to_bits);
        (self.at, self.overlay, bits(self.original), self.shown.map(bits))
            == (other.at, other.overlay, bits(other.original), other.shown.map(bits))
    }
}

/// The way in which values are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// Whole numbers from 0 to 255, as files with 8 bits have them.
    Bytes,
    /// All digits that a float has.
    Whole,
    /// So many digits after the point.
    Decimals(usize),
}

/// Forms in which floats are written, that with the most digits first.
const FLOATS: [Form; 4] = [Form::Whole, Form::Decimals(6), Form::Decimals(4), Form::Decimals(3)];

impl Form {
    fn number(self, value: f32) -> String {
        match self {
            _ if value.is_nan() => "unknown".into(),
            Self::Bytes => format!("{}", byte(value)),
            Self::Whole => format!("{value}"),
            Self::Decimals(digits) => format!("{value:.digits$}"),
        }
    }

    /// A difference, always with its sign.
    fn difference(self, before: f32, after: f32) -> String {
        match self {
            _ if before == after => "0".into(),
            // The difference of the numbers that are read.
            Self::Bytes => format!("{:+}", byte(after) - byte(before)),
            Self::Whole => format!("{:+}", after - before),
            Self::Decimals(digits) => format!("{:+.digits$}", after - before),
        }
    }
}

/// Rounded as files are written.
fn byte(value: f32) -> i32 {
    (value.clamp(0.0, 1.0) * 255.0).round() as i32
}

impl Probed {
    /// The pixel in words: the fullest first, others for less room after it. `is_bytes` says that the file has 8 bits.
    pub fn lines(&self, is_bytes: bool) -> Vec<String> {
        let [x, y] = self.at;
        let place = format!("{x}, {y}");
        let numbers = |form: Form, pixel: &[f32]| {
            pixel.iter().map(|value| form.number(*value)).collect::<Vec<_>>().join(" ")
        };
        if self.overlay != Overlay::None {
            let Some(shown) = self.shown else { return vec![place] };
            let layer = &shown[..channels(self.overlay)];
            let lines = FLOATS.iter().map(|form| format!("{place}   {}", numbers(*form, layer)));
            return lines.chain([place.clone()]).collect();
        }
        let forms: &[Form] = if is_bytes { &[Form::Bytes] } else { &FLOATS };
        let is_opaque = self.original[3] == 1.0 && self.shown.is_none_or(|shown| shown[3] == 1.0);
        let count = if is_opaque { 3 } else { 4 };
        let original = &self.original[..count];
        let Some(shown) = &self.shown else {
            let lines = forms.iter().map(|form| format!("{place}   {}", numbers(*form, original)));
            return lines.chain([place.clone()]).collect();
        };
        let shown = &shown[..count];
        let difference = |form: Form| {
            let pairs = original.iter().zip(shown);
            pairs.map(|(before, after)| form.difference(*before, *after)).collect::<Vec<_>>().join(" ")
        };
        let named = |form: &Form| {
            let [before, after] = [original, shown].map(|pixel| numbers(*form, pixel));
            format!("{place}   original {before}   look {after}   difference {}", difference(*form))
        };
        let short = |form: &Form| {
            let [before, after] = [original, shown].map(|pixel| numbers(*form, pixel));
            format!("{place}   {before} → {after}   {}", difference(*form))
        };
        let last = forms[forms.len() - 1];
        let [before, after] = [original, shown].map(|pixel| numbers(last, pixel));
        let rest = [format!("{place}   {before} → {after}"), format!("{place}   {after}"), place.clone()];
        forms.iter().flat_map(|form| [named(form), short(form)]).chain(rest).collect()
    }
}

/// Numbers that a layer has a pixel.
fn channels(overlay: Overlay) -> usize {
    match overlay {
        Overlay::Depth | Overlay::ObjectId => 1,
        Overlay::Motion => 2,
        _ => 3,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn probed(original: Pixel, shown: Option<Pixel>) -> Probed {
        Probed { at: [12, 7], original, shown, overlay: Overlay::None }
    }

    #[test]
    fn eight_bits_are_whole_numbers_whose_difference_adds_up() {
        let byte = |value: u8| f32::from(value) / 255.0;
        let pixel = probed([byte(200), byte(17), 0.0, 1.0], Some([0.5, byte(18), 2.0, 1.0]));
        let lines = pixel.lines(true);
        assert_eq!(lines[0], "12, 7   original 200 17 0   look 128 18 255   difference -72 +1 +255");
        assert_eq!(lines[1], "12, 7   200 17 0 → 128 18 255   -72 +1 +255");
        assert_eq!(lines.last().map(String::as_str), Some("12, 7"));
    }

    #[test]
    fn floats_have_all_their_digits_where_there_is_room() {
        let pixel = probed([0.123_456_79, 2.5, 0.0, 0.5], Some([0.25, 2.5, 1e-7, 0.5]));
        let lines = pixel.lines(false);
        let start = "12, 7   original 0.12345679 2.5 0 0.5   look 0.25 2.5 0.0000001 0.5";
        assert!(lines[0].starts_with(start), "{}", lines[0]);
        assert!(lines[1].starts_with("12, 7   0.12345679 2.5 0 0.5 → 0.25"), "{}", lines[1]);
        assert!(lines.contains(&"12, 7   0.123 2.500 0.000 0.500 → 0.250 2.500 0.000 0.500".into()));
        assert_eq!(probed([0.5; 4], None).lines(false)[0], "12, 7   0.5 0.5 0.5 0.5");
    }

    #[test]
    fn layers_are_shown_as_they_are() {
        let layer =
            |overlay, shown| Probed { overlay, ..probed([0.0; 4], Some(shown)) }.lines(true).remove(0);
        assert_eq!(layer(Overlay::Normal, [0.0, -0.5, 0.5, 1.0]), "12, 7   0 -0.5 0.5");
        assert_eq!(layer(Overlay::Depth, [123.25, 0.0, 0.0, 1.0]), "12, 7   123.25");
        assert_eq!(layer(Overlay::ObjectId, [17.0; 4]), "12, 7   17");
        assert_eq!(layer(Overlay::Motion, [f32::NAN, -1.5, 0.0, 1.0]), "12, 7   unknown -1.5");
        let pixel = Probed { overlay: Overlay::Motion, ..probed([0.0; 4], Some([f32::NAN; 4])) };
        assert_eq!(pixel, pixel, "what is no number does not ask for frames for ever");
    }
}
