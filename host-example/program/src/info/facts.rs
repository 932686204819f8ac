//! Facts by name, in order, as text and as JSON.

use serde::{Serialize, Serializer};
use serde_json::Value;

use isophote_files::error::{Error, Result};

/// Facts about a file.
#[derive(Debug, Default)]
pub struct Facts(Vec<Fact>);

#[derive(Debug)]
struct Fact {
    name: &'static str,
    value: Value,
    /// Text for people, where the value does not say it well.
    text: Option<String>,
}

impl Facts {
    /// Adds a fact.
    pub fn add(&mut self, name: &'static str, value: impl Into<Value>) {
        self.0.push(Fact { name, value: value.into(), text: None });
    }

    /// Adds a fact that people are told in other words.
    pub fn told(&mut self, name: &'static str, value: impl Into<Value>, text: impl Into<String>) {
        self.0.push(Fact { name, value: value.into(), text: Some(text.into()) });
    }

    /// Adds warnings about a file to those that are there, each of them once and without the file's name.
    pub fn warn(&mut self, file: &str, warnings: Vec<String>) {
        const NAME: &str = "warnings";
        if !self.0.iter().any(|fact| fact.name == NAME) {
            self.add(NAME, Value::Array(Vec::new()));
        }
        let all = self.0.iter_mut().find(|fact| fact.name == NAME);
        let Some(Value::Array(all)) = all.map(|fact| &mut fact.value) else { return };
        for warning in warnings {
            // Frames of a sequence have names of their own.
            let is_told = |known: &Value| {
                known
                    .as_str()
                    .is_some_and(|known| warning == known || warning.ends_with(&format!(": {known}")))
            };
            if !all.iter().any(is_told) {
                let text = warning.strip_prefix(&format!("{file}: ")).unwrap_or(&warning);
                all.push(text.into());
            }
        }
    }

    /// The facts as an object of JSON.
    ///
    /// # Errors
    /// [`Error::Failure`] when they are no JSON.
    pub fn json(&self) -> Result<String> {
        let text = serde_json::to_string_pretty(self)
            .map_err(|e| Error::failure(format!("cannot be written as JSON: {e}"), "leave out --json"))?;
        Ok(text + "\n")
    }

    /// A line for each fact, and one for each item of a list of several.
    pub fn text(&self) -> String {
        let width = self.0.iter().map(|fact| fact.name.len()).max().unwrap_or(0) + 2;
        let mut text = String::new();
        for Fact { name, value, text: told } in &self.0 {
            let lines = match (told, value) {
                (Some(told), _) => told.lines().map(str::to_owned).collect(),
                (None, Value::Array(items)) if items.len() > 1 && !items.iter().all(Value::is_number) => {
                    items.iter().map(shown).collect()
                }
                (None, value) => vec![shown(value)],
            };
            for (number, line) in lines.iter().enumerate() {
                let name = if number == 0 { name.replace('_', " ") } else { String::new() };
                text += format!("{name:width$}{line}").trim_end();
                text.push('\n');
            }
        }
        text
    }
}

impl Serialize for Facts {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|fact| (fact.name, &fact.value)))
    }
}

/// A value on one line.
fn shown(value: &Value) -> String {
    match value {
        Value::Null => "none".into(),
        Value::Bool(true) => "yes".into(),
        Value::Bool(false) => "no".into(),
        Value::String(text) => text.clone(),
        Value::Number(number) => number.to_string(),
        Value::Array(items) if items.is_empty() => "none".into(),
        Value::Array(items) => items.iter().map(shown).collect::<Vec<_>>().join(", "),
        Value::Object(fields) => {
            let mut fields: Vec<(&String, &Value)> = fields.iter().filter(|(_, v)| !v.is_null()).collect();
            // What it is called comes first.
            fields.sort_by_key(|(name, _)| *name != "name");
            let text = |(name, value): &(&String, &Value)| match name.as_str() {
                "name" => shown(value),
                name => format!("{} {}", name.replace('_', " "), shown(value)),
            };
            fields.iter().map(text).collect::<Vec<_>>().join(", ")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn facts_are_lines_and_names_of_json_in_order() {
        let mut facts = Facts::default();
        facts.add("size", json!([4, 2]));
        facts.told("pixel_aspect", 2.0, "2, wide");
        facts.add("layers", json!([{"data": true, "name": "Z"}, {"name": "main", "views": null}]));
        facts.add("warnings", json!([]));
        assert_eq!(
            facts.text(),
            "size          4, 2\npixel aspect  2, wide\nlayers        Z, data yes\n              main\nwarnings      none\n"
        );
        let json = facts.json().unwrap();
        let places = ["size", "pixel_aspect", "layers", "warnings"].map(|name| json.find(name).unwrap());
        assert!(places.is_sorted(), "{json}");
    }
}
