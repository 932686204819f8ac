//! Values of a look's parameters, each of its parameter's type. They are text where a file is read or written, and nowhere else.

use std::path::Path;

use isophote_files::error::Result;
use isophote_finishing::stylize::preset::{self, Lengths, ObjectRule, Preset, Title, Track};
use isophote_finishing::stylize::value::Value;
use isophote_loader::catalogue::ParamKind;

/// Value of one parameter.
#[derive(Clone, Debug)]
pub enum ParamValue {
    /// The same for all frames.
    Typed(Value),
    /// Words of a file that are no such value, or another spelling of it, so that they are written as they were read.
    Text(Track),
}

impl PartialEq for ParamValue {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Typed(a), Self::Typed(b)) => a == b,
            (Self::Text(a), Self::Text(b)) => a == b,
            (Self::Typed(value), Self::Text(Track::Still(text)))
            | (Self::Text(Track::Still(text)), Self::Typed(value)) => value.text() == *text,
            _ => false,
        }
    }
}

impl ParamValue {
    /// The value at the first keyframe, or everywhere.
    pub fn first(&self, kind: &ParamKind) -> Option<Value> {
        match self {
            Self::Typed(value) => Some(value.clone()),
            Self::Text(Track::Still(text)) => Value::parse(kind, text),
            Self::Text(Track::Keys { keys, .. }) => {
                keys.first().and_then(|(_, text)| Value::parse(kind, text))
            }
        }
    }

    /// True where it changes from frame to frame.
    pub fn is_animated(&self) -> bool {
        matches!(self, Self::Text(Track::Keys { .. }))
    }

    fn track(&self) -> Track {
        match self {
            Self::Typed(value) => Track::Still(value.text()),
            Self::Text(track) => track.clone(),
        }
    }
}

/// Values under the names of their parameters, in the order of a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Values(Vec<(String, ParamValue)>);

impl Values {
    fn read(params: Vec<(String, Track)>) -> Self {
        Self(params.into_iter().map(|(name, track)| (name, ParamValue::Text(track))).collect())
    }

    fn written(&self) -> Vec<(String, Track)> {
        self.0.iter().map(|(name, param)| (name.clone(), param.track())).collect()
    }

    /// Gives all values the types of their parameters, whose kinds are given by their names.
    pub fn take_types<'k>(&mut self, kind: impl Fn(&str) -> Option<&'k ParamKind>) {
        for (name, param) in &mut self.0 {
            let ParamValue::Text(Track::Still(text)) = param else { continue };
            let value = kind(name).and_then(|kind| Value::parse(kind, text));
            if let Some(value) = value.filter(|value| value.text() == *text) {
                *param = ParamValue::Typed(value);
            }
        }
    }

    /// The value of a parameter, if it has one.
    pub fn get(&self, name: &str) -> Option<&ParamValue> {
        self.0.iter().rev().find(|(known, _)| known == name).map(|(_, param)| param)
    }

    /// Gives a parameter a value.
    pub fn set(&mut self, name: &str, value: &Value) {
        self.put(name, ParamValue::Typed(value.clone()));
    }

    /// Gives a parameter a value that may be written in words of its own.
    pub fn put(&mut self, name: &str, param: ParamValue) {
        match self.0.iter_mut().find(|(known, _)| known == name) {
            Some((_, old)) => *old = param,
            None => self.0.push((name.to_owned(), param)),
        }
    }

    /// Takes the value of a parameter away.
    pub fn remove(&mut self, name: &str) {
        self.0.retain(|(known, _)| known != name);
    }

    /// Takes all values away.
    pub fn clear(&mut self) {
        self.0.clear();
    }

    /// Keeps the values of those parameters whose names are wanted.
    pub fn retain(&mut self, is_wanted: impl Fn(&str) -> bool) {
        self.0.retain(|(name, _)| is_wanted(name));
    }

    /// Gives parameters other names.
    pub fn rename(&mut self, new: impl Fn(&str) -> Option<String>) {
        for (name, _) in &mut self.0 {
            if let Some(new) = new(name) {
                *name = new;
            }
        }
    }

    /// True where no parameter has a value.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// True where the same parameters have the same values as in another, in whatever order.
    fn says_the_same(&self, other: &Self) -> bool {
        let sorted = |values: &Self| {
            let mut values = values.0.clone();
            values.sort_by(|(a, _), (b, _)| a.cmp(b));
            values
        };
        sorted(self) == sorted(other)
    }
}

/// A preset whose values are typed.
#[derive(Clone, Debug, PartialEq)]
pub struct TypedPreset {
    /// Its name, description and tags.
    pub title: Title,
    /// The id of a node, the path of a graph file, or the JSON of a graph.
    pub style: String,
    /// Meaning of lengths, where it is said.
    pub lengths: Option<Lengths>,
    /// Values of its parameters.
    pub params: Values,
    /// Rules for things in the picture, which are kept as they are.
    pub objects: Vec<ObjectRule>,
}

impl TypedPreset {
    /// A style without any settings.
    pub fn bare(style: String) -> Self {
        Self { title: Title::default(), style, lengths: None, params: Values::default(), objects: Vec::new() }
    }

    /// The preset of a file whose text was read; its values have no types yet.
    ///
    /// # Errors
    /// As [`preset::parse`].
    pub fn parse(path: &Path, text: &str) -> Result<Self> {
        let Preset { title, style, lengths, params, objects } = preset::parse(path, text)?;
        Ok(Self { title, style, lengths, params: Values::read(params), objects })
    }

    /// The preset as files hold it.
    pub fn written(&self) -> Preset {
        let Self { title, style, lengths, params, objects } = self.clone();
        Preset { title, style, lengths, params: params.written(), objects }
    }

    /// True where it gives the same pictures by the same words. Names and tags are written when they are typed.
    pub fn says_the_same(&self, other: &Self) -> bool {
        self.style == other.style
            && self.lengths == other.lengths
            && self.objects == other.objects
            && self.params.says_the_same(&other.params)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_typed_where_nothing_of_them_is_lost() {
        let kind = ParamKind::Float { default: 1.0, range: [0.0, 9.0], slider: [0.0, 9.0] };
        let keys = Track::Keys { keys: vec![(1, "2".into()), (9, "3".into())], step: None };
        let still = |text: &str| Track::Still(text.to_owned());
        let params = [("a", still("2.5")), ("b", still("2.50")), ("c", keys), ("d", still("0.5"))];
        let params: Vec<(String, Track)> =
            params.into_iter().map(|(name, track)| (name.to_owned(), track)).collect();
        let mut values = Values::read(params.clone());
        let untyped = values.clone();
        values.take_types(|name| (name != "d").then_some(&kind));
        assert_eq!((&values, values.written()), (&untyped, params));
        let is_typed = |name: &str| matches!(values.get(name), Some(ParamValue::Typed(_)));
        assert_eq!(["a", "b", "c", "d"].map(is_typed), [true, false, false, false]);
        let first = |name: &str| values.get(name).and_then(|param| param.first(&kind));
        assert_eq!(["a", "b", "c"].map(first), [2.5, 2.5, 2.0].map(|v| Some(Value::Float(v))));
        assert!(values.get("c").is_some_and(ParamValue::is_animated));
    }

    #[test]
    fn values_are_set_in_their_place_and_compared_whatever_their_order() {
        let mut values = Values::default();
        for (name, value) in [("a", 1), ("b", 2), ("a", 3)] {
            values.set(name, &Value::Int(value));
        }
        let written = [("a", "3"), ("b", "2")].map(|(name, text)| (name.into(), Track::Still(text.into())));
        assert_eq!(values.written(), written);
        let mut other = Values::read(written.into_iter().rev().collect());
        assert!(values.says_the_same(&other) && values != other);
        other.remove("a");
        assert!(!values.says_the_same(&other) && !other.is_empty());
    }
}
