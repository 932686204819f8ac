//! Values of parameters, and all that the library and its faces know about their types.

use serde_json::{Value as Json, json};

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
    /// What it does.
    pub doc: &'static str,
}

/// A value as numbers, and how values of its type are described, read and written.
#[derive(Clone, Copy, Debug)]
pub struct Form {
    /// The value: a switch is 0 or 1, a choice the index of its option.
    pub numbers: [f64; 4],
    /// How many of the numbers count; the others are 0.
    pub count: usize,
    /// The value of the same type with other numbers. They must be in range.
    pub value: fn([f64; 4]) -> Value,
    /// What a person may write, for a parameter with this range and these options.
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
                expected: |_, _| "a colour such as #12407b or 0.1,0.2,0.5".into(),
                read: |text, _| parse_color(text).map(|v| v.map(f64::from)),
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

/// `#rrggbb`, `#rrggbbaa`, or three or four numbers 0..=1 with commas between.
fn parse_color(text: &str) -> Option<[f32; 4]> {
    if let Some(hex) = text.strip_prefix('#') {
        if !hex.is_ascii() || !(hex.len() == 6 || hex.len() == 8) {
            return None;
        }
        let mut color = [1.0; 4];
        for (i, channel) in color.iter_mut().enumerate().take(hex.len() / 2) {
            *channel = f32::from(u8::from_str_radix(&hex[2 * i..2 * i + 2], 16).ok()?) / 255.0;
        }
        return Some(color);
    }
    let values: Vec<f32> = text.split(',').map(|v| v.trim().parse().ok()).collect::<Option<_>>()?;
    match values[..] {
        [r, g, b] => Some([r, g, b, 1.0]),
        [r, g, b, a] => Some([r, g, b, a]),
        _ => None,
    }
}
