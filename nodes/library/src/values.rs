//! Parameter values: checked against their declaration, read from text and JSON.

use crate::error::{Error, Result, nearest};
use crate::spec::{Choice, NodeSpec, Param, ParamKind};

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

/// Checks `value` against the declaration of `param` of `node`.
///
/// # Errors
/// [`Error::Value`] for another type, a value outside the hard range, or one that is not finite.
pub fn check(node: &NodeSpec, param: &Param, value: Value) -> Result<Value> {
    let what = || format!("parameter '{}' of '{}'", param.id, node.id);
    match (param.kind, value) {
        (ParamKind::Float { range, .. }, Value::Float(v)) => {
            if !v.is_finite() || v < range[0] || v > range[1] {
                return Err(Error::Value(format!(
                    "{} must be {} to {}, not {v}",
                    what(),
                    range[0],
                    range[1]
                )));
            }
        }
        // A whole number is a number too.
        (ParamKind::Float { .. }, Value::Int(v)) => return check(node, param, Value::Float(v as f32)),
        (ParamKind::Int { range, .. }, Value::Int(v)) => {
            if v < range[0] || v > range[1] {
                return Err(Error::Value(format!(
                    "{} must be {} to {}, not {v}",
                    what(),
                    range[0],
                    range[1]
                )));
            }
        }
        (ParamKind::Int { .. }, Value::Float(v)) if v.fract() == 0.0 && v.abs() < 1e9 => {
            return check(node, param, Value::Int(v as i32));
        }
        (ParamKind::Choice { options, .. }, Value::Choice(v)) => {
            if v >= options.len() {
                return Err(Error::Value(format!("{} has {} options, not {v}", what(), options.len())));
            }
        }
        (ParamKind::Color { .. }, Value::Color(v)) => {
            if v.iter().any(|c| !c.is_finite() || *c < 0.0 || *c > 1.0) {
                return Err(Error::Value(format!("{} must be RGBA values 0 to 1, not {v:?}", what())));
            }
        }
        (ParamKind::Bool { .. }, Value::Bool(_)) => {}
        (kind, _) => return Err(Error::Value(format!("{} is {}", what(), type_name(&kind)))),
    }
    Ok(value)
}

/// Reads a value written by a person: `2.5`, `true`, `scharr3`, `#12407b`, `0.1,0.2,0.5`.
///
/// # Errors
/// [`Error::Value`] when the text is not of the parameter's type or out of range, and
/// [`Error::Unknown`] for an option that does not exist.
pub fn parse(node: &NodeSpec, param: &Param, text: &str) -> Result<Value> {
    let text = text.trim();
    let wrong = || {
        Error::Value(format!(
            "parameter '{}' of '{}' is {}, not '{text}'",
            param.id,
            node.id,
            type_name(&param.kind)
        ))
    };
    let value = match param.kind {
        ParamKind::Float { .. } => Value::Float(text.parse().map_err(|_| wrong())?),
        ParamKind::Int { .. } => Value::Int(text.parse().map_err(|_| wrong())?),
        ParamKind::Bool { .. } => match text {
            "true" | "on" | "yes" | "1" => Value::Bool(true),
            "false" | "off" | "no" | "0" => Value::Bool(false),
            _ => return Err(wrong()),
        },
        ParamKind::Choice { options, .. } => Value::Choice(option(node, param, options, text)?),
        ParamKind::Color { .. } => Value::Color(parse_color(text).ok_or_else(wrong)?),
    };
    check(node, param, value)
}

/// Index of an option by id.
///
/// # Errors
/// [`Error::Unknown`], naming the options.
pub fn option(node: &NodeSpec, param: &Param, options: &[Choice], id: &str) -> Result<usize> {
    options.iter().position(|o| o.id == id).ok_or_else(|| {
        let known: Vec<&str> = options.iter().map(|o| o.id).collect();
        Error::Unknown(format!(
            "parameter '{}' of '{}' is one of {}, not '{id}'{}",
            param.id,
            node.id,
            known.join(", "),
            nearest(id, known.iter().copied())
        ))
    })
}

/// `#rrggbb`, `#rrggbbaa`, or three or four numbers 0..=1 with commas between.
pub fn parse_color(text: &str) -> Option<[f32; 4]> {
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

fn type_name(kind: &ParamKind) -> String {
    match kind {
        ParamKind::Float { range, .. } => format!("a number {} to {}", range[0], range[1]),
        ParamKind::Int { range, .. } => format!("a whole number {} to {}", range[0], range[1]),
        ParamKind::Bool { .. } => "true or false".into(),
        ParamKind::Choice { options, .. } => {
            format!("one of {}", options.iter().map(|o| o.id).collect::<Vec<_>>().join(", "))
        }
        ParamKind::Color { .. } => "a colour such as #12407b or 0.1,0.2,0.5".into(),
    }
}
