//! The declaration of a parameter, and values checked against it.

use crate::declare::choice::{Selectable, Selection};
use crate::declare::value::{Choice, Value};
use crate::error::{Error, Result, nearest};
use std::mem::discriminant;

/// Unit of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// None.
    None,
    /// Pixels of the full-size picture; scaled with the host's render scale.
    Pixels,
    /// Share of something, 0..100.
    Percent,
    /// Degrees of angle.
    Degrees,
}

impl Unit {
    /// Name in the catalogue; empty for none.
    pub const fn id(self) -> &'static str {
        match self {
            Self::None => "",
            Self::Pixels => "px",
            Self::Percent => "%",
            Self::Degrees => "deg",
        }
    }
}

/// A hint and the documentation that follows it, after an empty line.
pub(crate) fn paragraphs(hint: &str, doc: &str) -> String {
    if doc.is_empty() { hint.to_owned() } else { format!("{hint}\n\n{doc}") }
}

/// One parameter of a node.
#[derive(Clone, Copy, Debug)]
pub struct Param {
    /// Stable name.
    pub id: &'static str,
    /// For people.
    pub label: &'static str,
    /// One sentence or two in artists' words, which panels show beside the control.
    pub hint: &'static str,
    /// Documentation that follows the hint: symbols, equations and sources in the thesis; empty where the hint says all.
    pub doc: &'static str,
    /// Default; its type is the parameter's.
    pub default: Value,
    /// Hard range of each number of a value; values outside are refused.
    pub range: [f32; 2],
    /// Range of a slider.
    pub slider: [f32; 2],
    /// All options of a choice; order is for people, ids are for ever. Empty for other types.
    pub options: &'static [Choice],
    /// Unit of a number.
    pub unit: Unit,
    /// Heading under which panels show it; empty for the node's own.
    pub group: &'static str,
    /// True when changing it may change the list of passes and not only uniform bytes.
    pub structural: bool,
    /// True when the node gives its picture back unchanged while this number is 0.
    pub neutral_at_zero: bool,
}

impl Param {
    /// A parameter of the type of its default, whose slider has all of the range.
    pub const fn new(id: &'static str, label: &'static str, default: Value, range: [f32; 2]) -> Self {
        Self {
            id,
            label,
            hint: "",
            doc: "",
            default,
            range,
            slider: range,
            options: &[],
            unit: Unit::None,
            group: "",
            structural: false,
            neutral_at_zero: false,
        }
    }

    /// A number.
    pub const fn float(id: &'static str, label: &'static str, default: f32, range: [f32; 2]) -> Self {
        Self::new(id, label, Value::Float(default), range)
    }

    /// A length in pixels of the full-size picture.
    pub const fn length(id: &'static str, label: &'static str, default: f32, range: [f32; 2]) -> Self {
        Self { unit: Unit::Pixels, ..Self::float(id, label, default, range) }
    }

    /// A whole number.
    pub const fn int(id: &'static str, label: &'static str, default: i32, range: [i32; 2]) -> Self {
        Self::new(id, label, Value::Int(default), [range[0] as f32, range[1] as f32])
    }

    /// On or off.
    pub const fn bool(id: &'static str, label: &'static str, default: bool) -> Self {
        Self::new(id, label, Value::Bool(default), [0.0, 1.0])
    }

    /// One of several; structural until said otherwise, since choices usually pick a kernel.
    pub const fn choice(id: &'static str, label: &'static str, default: Selection) -> Self {
        let last = default.options.len() as f32 - 1.0;
        let param = Self::new(id, label, Value::Choice(default.index), [0.0, last]);
        Self { options: default.options, ..param }.structural()
    }

    /// A colour, gamma-encoded RGBA, 0..=1.
    pub const fn color(id: &'static str, label: &'static str, default: [f32; 4]) -> Self {
        Self::new(id, label, Value::Color(default), [0.0, 1.0])
    }

    /// The range of a slider, within the hard range.
    pub const fn slider(mut self, low: f32, high: f32) -> Self {
        self.slider = [low, high];
        self
    }

    /// The hint of panels.
    pub const fn hint(mut self, hint: &'static str) -> Self {
        self.hint = hint;
        self
    }

    /// The documentation that follows the hint.
    pub const fn doc(mut self, doc: &'static str) -> Self {
        self.doc = doc;
        self
    }

    /// All that is written about it: the hint, an empty line, and the documentation where there is any.
    pub fn text(&self) -> String {
        paragraphs(self.hint, self.doc)
    }

    /// Another default of the same type.
    pub const fn with_default(mut self, default: Value) -> Self {
        self.default = default;
        self
    }

    /// Measured in degrees.
    pub const fn degrees(mut self) -> Self {
        self.unit = Unit::Degrees;
        self
    }

    /// Shown under a heading.
    pub const fn group(mut self, group: &'static str) -> Self {
        self.group = group;
        self
    }

    /// Changing it may change the list of passes.
    pub const fn structural(mut self) -> Self {
        self.structural = true;
        self
    }

    /// At 0 the node gives its picture back unchanged.
    pub const fn neutral_at_zero(mut self) -> Self {
        self.neutral_at_zero = true;
        self
    }

    /// Changing it only changes uniform bytes.
    pub const fn uniform(mut self) -> Self {
        self.structural = false;
        self
    }

    /// The default of a number, lengths in pixels of the full-size picture. Panics for other types, at
    /// compile time in constants.
    pub const fn default_float(&self) -> f32 {
        match self.default {
            Value::Float(v) => v,
            _ => panic!("not a number"),
        }
    }

    /// The default of a switch. Panics for other types, at compile time in constants.
    pub const fn default_bool(&self) -> bool {
        match self.default {
            Value::Bool(v) => v,
            _ => panic!("not a switch"),
        }
    }

    /// The default of a choice. Panics for other types.
    pub fn default_option<T: Selectable>(&self) -> T {
        self.option(self.default)
    }

    /// The option that a value of this parameter stands for. Panics for values of other types and for
    /// choices with other options.
    pub(crate) fn option<T: Selectable>(&self, value: Value) -> T {
        let ids = |options: &'static [Choice]| options.iter().map(|o| o.id);
        match value {
            Value::Choice(index) if ids(self.options).eq(ids(T::OPTIONS)) => T::ALL[index],
            other => panic!("'{}' is {other:?}, of other options", self.id),
        }
    }

    /// The default of a whole number. Panics for other types, at compile time in constants.
    pub const fn default_int(&self) -> i32 {
        match self.default {
            Value::Int(v) => v,
            _ => panic!("not a whole number"),
        }
    }

    /// `value` as a value of this parameter of `node`: a whole number is a number too.
    ///
    /// # Errors
    /// [`Error::Value`] for another type, a value outside the hard range, or one that is not finite.
    pub fn check(&self, node: &str, value: Value) -> Result<Value> {
        let value = match (self.default, value) {
            (Value::Float(_), Value::Int(v)) => Value::Float(v as f32),
            (Value::Int(_), Value::Float(v)) if v.fract() == 0.0 && v.abs() < 1e9 => Value::Int(v as i32),
            _ => value,
        };
        if discriminant(&value) != discriminant(&self.default) {
            return Err(Error::Value(format!("{} is {}", self.name(node), self.expected())));
        }
        let (form, [low, high]) = (value.form(), self.range);
        let allowed = f64::from(low)..=f64::from(high);
        match form.numbers[..form.count].iter().find(|n| !allowed.contains(n)) {
            Some(n) => {
                Err(Error::Value(format!("{} must be {low} to {high}, not {}", self.name(node), *n as f32)))
            }
            None => Ok(value),
        }
    }

    /// The value of these numbers, each moved into the range. They must not be NaN.
    pub fn nearest(&self, numbers: [f64; 4]) -> Value {
        let [low, high] = self.range.map(f64::from);
        (self.default.form().value)(numbers.map(|n| n.clamp(low, high)))
    }

    /// Reads a value of this parameter of `node` that a person wrote: `2.5`, `true`, `scharr3`, `#12407b`,
    /// `0.1,0.2,0.5`.
    ///
    /// # Errors
    /// [`Error::Value`] when the text is not of the parameter's type or out of range, and
    /// [`Error::Unknown`], naming the nearest, for an option that does not exist.
    pub fn parse(&self, node: &str, text: &str) -> Result<Value> {
        let (text, form) = (text.trim(), self.default.form());
        if let Some(numbers) = (form.read)(text, self.options) {
            return self.check(node, (form.value)(numbers));
        }
        let hint = nearest(text, self.options.iter().map(|o| o.id));
        let message = format!("{} is {}, not '{text}'{hint}", self.name(node), self.expected());
        Err(if self.options.is_empty() { Error::Value(message) } else { Error::Unknown(message) })
    }

    fn name(&self, node: &str) -> String {
        format!("parameter '{}' of '{node}'", self.id)
    }

    fn expected(&self) -> String {
        (self.default.form().expected)(self.range, self.options)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_of_every_type_go_through_text_numbers_and_json() {
        let options: &[Choice] =
            &[Choice { id: "a", label: "A", doc: "A." }, Choice { id: "b", label: "B", doc: "B." }];
        let params = [
            (Param::float("p", "P", 0.5, [0.0, 1.0]), "0.1", "0.1", Value::Float(0.1)),
            (Param::int("p", "P", 2, [0, 9]), "7", "7", Value::Int(7)),
            (Param::bool("p", "P", false), "on", "true", Value::Bool(true)),
            (Param::choice("p", "P", Selection { index: 0, options }), "b", "\"b\"", Value::Choice(1)),
            (
                Param::color("p", "P", [0.0; 4]),
                "#ff000033",
                "[1.0,0.0,0.0,0.2]",
                Value::Color([1.0, 0.0, 0.0, 0.2]),
            ),
        ];
        for (param, text, json, value) in params {
            assert_eq!(param.parse("n", text).unwrap(), value);
            assert_eq!(param.check("n", value).unwrap(), value);
            let form = value.form();
            assert_eq!((form.json)(form.numbers, param.options).to_string(), json);
            assert_eq!(param.nearest(form.numbers), value);
            assert!(param.parse("n", "what").is_err() && param.parse("n", "").is_err());
            let beyond = (form.value)([1e6; 4]);
            assert_eq!(param.check("n", beyond).is_ok(), matches!(value, Value::Bool(_)), "{beyond:?}");
            assert!(param.check("n", param.nearest([1e6; 4])).is_ok());
        }
    }

    #[test]
    fn numbers_are_taken_as_the_type_that_is_declared() {
        let (float, int) = (Param::float("p", "P", 0.5, [0.0, 4.0]), Param::int("p", "P", 2, [0, 9]));
        assert_eq!(float.check("n", Value::Int(3)).unwrap(), Value::Float(3.0));
        assert_eq!(int.check("n", Value::Float(3.0)).unwrap(), Value::Int(3));
        for bad in [Value::Float(3.5), Value::Float(f32::NAN), Value::Float(-1.0), Value::Bool(true)] {
            assert!(int.check("n", bad).is_err(), "{bad:?}");
        }
    }
}
