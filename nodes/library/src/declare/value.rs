//! Values of parameters, and all that the library and its faces know about their types.

use crate::error::{Error, Result};
use serde_json::{Value as Json, json};
use std::ops::Div;
use std::str::FromStr;

/// The value of a parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// A number.
    Float(f32),
    /// A whole number.
    Int(i32),
    /// On or off.
    Bool(bool),
    /// Index of an option.
    Choice(usize),
    /// Gamma-encoded RGBA.
    Color([f32; 4]),
}

/// One option of a choice.
#[derive(Clone, Copy, Debug)]
pub struct Choice {
    /// Stable name.
    pub id: &'static str,
    /// For people.
    pub label: &'static str,
    /// One sentence, which panels show beside the option.
    pub doc: &'static str,
}

/// A value as numbers, and how values of its type are described, read and written.
#[derive(Clone, Copy, Debug)]
pub struct Form {
    /// The value: a switch is 0 or 1, a choice the index of its option.
    pub numbers: [f64; 4],
    /// Count of the numbers that are meant; the others are 0.
    pub count: usize,
    /// The value of the same type with other numbers. They must be in range.
    pub value: fn([f64; 4]) -> Value,
    /// Spelling that a person may use, for a parameter with this range and these options.
    pub expected: fn([f32; 2], &[Choice]) -> String,
    /// The numbers that a person wrote.
    pub read: fn(&str, &[Choice]) -> Option<[f64; 4]>,
    /// The value with these numbers in a graph file.
    pub json: fn([f64; 4], &[Choice]) -> Json,
}

impl Value {
    /// The value as numbers and what there is to know about its type. This is the one place where the
    /// library tells types apart: another type is a variant of [`Value`] and its arm here.
    pub fn form(self) -> Form {
        match self {
            Self::Float(v) => Form {
                numbers: one(v.into()),
                count: 1,
                value: |n| Self::Float(n[0] as f32),
                expected: |[low, high], _| format!("a number {low} to {high}"),
                read: |text, _| text.parse::<f32>().ok().map(|v| one(v.into())),
                json: |n, _| json!(decimal(n[0] as f32)),
            },
            Self::Int(v) => Form {
                numbers: one(v.into()),
                count: 1,
                value: |n| Self::Int(n[0] as i32),
                expected: |[low, high], _| format!("a whole number {low} to {high}"),
                read: |text, _| text.parse::<i32>().ok().map(|v| one(v.into())),
                json: |n, _| json!(n[0] as i32),
            },
            Self::Bool(v) => Form {
                numbers: one(u8::from(v).into()),
                count: 1,
                value: |n| Self::Bool(n[0] != 0.0),
                expected: |_, _| "true or false".into(),
                read: |text, _| match text {
                    "true" | "on" | "yes" | "1" => Some(one(1.0)),
                    "false" | "off" | "no" | "0" => Some(one(0.0)),
                    _ => None,
                },
                json: |n, _| json!(n[0] != 0.0),
            },
            Self::Choice(v) => Form {
                numbers: one(v as f64),
                count: 1,
                value: |n| Self::Choice(n[0] as usize),
                expected: |_, options| {
                    format!("one of {}", options.iter().map(|o| o.id).collect::<Vec<_>>().join(", "))
                },
                read: |text, options| options.iter().position(|o| o.id == text).map(|v| one(v as f64)),
                json: |n, options| options.get(n[0] as usize).map_or(Json::Null, |o| json!(o.id)),
            },
            Self::Color(v) => Form {
                numbers: v.map(f64::from),
                count: 4,
                value: |n| Self::Color(n.map(|v| v as f32)),
                expected: |_, _| COLOUR.into(),
                read: |text, _| channels_from_text::<f32>(text).map(|v| v.map(f64::from)),
                json: |n, _| json!(n.map(|v| decimal(v as f32))),
            },
        }
    }

    /// The value as numbers that print as they were meant: 0.1 and not 0.10000000149.
    pub fn decimals(self) -> [f64; 4] {
        self.form().numbers.map(|n| if n.fract() == 0.0 { n } else { decimal(n as f32) })
    }
}

const fn one(number: f64) -> [f64; 4] {
    [number, 0.0, 0.0, 0.0]
}

/// The double that prints like the float: 0.1 and not 0.10000000149.
pub fn decimal(value: f32) -> f64 {
    value.to_string().parse().unwrap_or(f64::from(value))
}

/// Forms in which people write colours.
const COLOUR: &str = "a colour such as #12407b or 0.1,0.2,0.5";

/// A channel of a colour, in the precision that its reader needs.
pub(crate) trait Channel: FromStr + From<u8> + Div<Output = Self> + Copy {}

impl Channel for f32 {}
impl Channel for f64 {}

/// The channels of a colour that a person wrote: `#rrggbb`, `#rrggbbaa`, or three or four numbers with commas between.
/// A colour without opacity is opaque. The range of the numbers is not looked at.
pub(crate) fn channels_from_text<T: Channel>(text: &str) -> Option<[T; 4]> {
    let mut color = [T::from(1); 4];
    let text = text.trim();
    if let Some(hex) = text.strip_prefix('#') {
        // Signs are no digits, though numbers may begin with them.
        if !(hex.len() == 6 || hex.len() == 8) || !hex.bytes().all(|digit| digit.is_ascii_hexdigit()) {
            return None;
        }
        for (channel, at) in color.iter_mut().zip((0..hex.len()).step_by(2)) {
            *channel = T::from(u8::from_str_radix(&hex[at..at + 2], 16).ok()?) / T::from(255);
        }
        return Some(color);
    }
    let values: Vec<T> = text.split(',').map(|v| v.trim().parse().ok()).collect::<Option<_>>()?;
    color.get_mut(..values.len())?.copy_from_slice(&values);
    (values.len() >= 3).then_some(color)
}

/// The colour that a person wrote: gamma-encoded RGBA, 0 to 1.
///
/// # Errors
/// [`Error::Value`] for text that is none.
pub fn color_from_text(text: &str) -> Result<[f32; 4]> {
    let color = channels_from_text(text).filter(|color| color.iter().all(|v| (0.0..=1.0).contains(v)));
    color.ok_or_else(|| Error::Value(format!("'{text}' is no colour; write {COLOUR}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_read_in_one_way() {
        for (text, wanted) in [
            ("#ff0033", [1.0, 0.0, 0.2, 1.0]),
            (" #FF003300 ", [1.0, 0.0, 0.2, 0.0]),
            ("1, 0,0.2", [1.0, 0.0, 0.2, 1.0]),
            ("1,0,0.2,0.5", [1.0, 0.0, 0.2, 0.5]),
        ] {
            assert_eq!(color_from_text(text).ok(), Some(wanted), "{text}");
        }
        let bad = [
            "",
            "red",
            "#12345",
            "#1234567",
            "#+1+2+3",
            "#ggffff",
            "#é12345",
            "# f00000",
            "1",
            "1,2",
            "0,0,0,0,0",
        ];
        for text in bad.into_iter().chain(["nan,0,0", "0,0,2", "0,-1,0", "0,,0"]) {
            let error = color_from_text(text).unwrap_err().to_string();
            assert!(error.contains("#12407b"), "{text}: {error}");
        }
    }

    #[test]
    fn both_precisions_give_the_same_colour() {
        for byte in 0..=255u8 {
            let text = format!("#{byte:02x}{byte:02x}{byte:02x}");
            let (single, double) = (channels_from_text::<f32>(&text), channels_from_text::<f64>(&text));
            assert_eq!(single, double.map(|color| color.map(|v| v as f32)));
        }
    }
}
