//! The title of a preset: text for people who look for one.

use super::fault::Fault;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

/// Its keys in the file.
pub(super) const KEYS: [&str; 3] = ["name", "about", "tags"];

/// The name of a preset, what it looks like, and words by which it is found. All may be left out.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Title {
    /// The name, one line.
    pub name: Option<String>,
    /// Description of the look, one line.
    pub about: Option<String>,
    /// Words by which it is found.
    pub tags: Vec<String>,
}

impl Title {
    /// Takes the title out of the file `place`. Its faults are added to `faults`.
    pub(super) fn take(place: &str, file: &mut Map<String, Value>, faults: &mut Vec<Fault>) -> Self {
        let [name, about, tags] = KEYS;
        let mut text = |key: &str| match file.remove(key) {
            None => None,
            Some(value) => line(value).or_else(|| {
                let fix = format!("write \"{key}\": \"...\" on one line");
                faults.push(Fault::format(place, format!("its {key} is no line of text"), fix));
                None
            }),
        };
        let (name, about) = (text(name), text(about));
        let tags = match file.remove(tags) {
            None => Some(Vec::new()),
            Some(Value::Array(list)) => list.into_iter().map(line).collect(),
            Some(_) => None,
        };
        if tags.is_none() {
            let fix = "write \"tags\": [\"warm\", \"drawing\"]";
            faults.push(Fault::format(place, "its tags are no list of words", fix));
        }
        Self { name, about, tags: tags.unwrap_or_default() }
    }

    /// Adds what there is to a file.
    pub(super) fn put(&self, file: &mut Map<String, Value>) {
        let [name, about, tags] = KEYS;
        for (key, text) in [(name, &self.name), (about, &self.about)] {
            if let Some(text) = text {
                file.insert(key.into(), text.as_str().into());
            }
        }
        if !self.tags.is_empty() {
            file.insert(tags.into(), self.tags.as_slice().into());
        }
    }

    /// Itself, with what it leaves out taken from another.
    pub fn or(self, other: Self) -> Self {
        Self {
            name: self.name.or(other.name),
            about: self.about.or(other.about),
            tags: if self.tags.is_empty() { other.tags } else { self.tags },
        }
    }
}

/// A text that has letters and is one line.
fn line(value: Value) -> Option<String> {
    match value {
        Value::String(text) if is_line(&text) => Some(text),
        _ => None,
    }
}

/// True for a text that can be a name, a description or a tag.
pub fn is_line(text: &str) -> bool {
    !text.trim().is_empty() && !text.chars().any(char::is_control)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn take(text: &str) -> (Title, Vec<String>) {
        let mut file = serde_json::from_str(text).expect("the text is an object");
        let mut faults = Vec::new();
        let title = Title::take("p.json", &mut file, &mut faults);
        assert!(KEYS.iter().all(|key| !file.contains_key(*key)));
        (title, faults.iter().map(ToString::to_string).collect())
    }

    #[test]
    fn a_title_is_read_and_written() {
        let text = r#"{"name": "Dusk", "about": "Soft lines.", "tags": ["soft", "évening"]}"#;
        let (title, faults) = take(text);
        assert!(faults.is_empty(), "{faults:?}");
        let mut file = Map::new();
        title.put(&mut file);
        assert_eq!(Value::Object(file), serde_json::from_str::<Value>(text).expect("it is JSON"));
        let mut file = Map::new();
        take("{}").0.put(&mut file);
        assert!(file.is_empty());
    }

    #[test]
    fn what_is_left_out_is_taken_from_another() {
        let [whole, part] = [r#"{"name": "A", "about": "B", "tags": ["c"]}"#, r#"{"name": "D"}"#];
        let [whole, part] = [whole, part].map(|text| take(text).0);
        assert_eq!(Title::default().or(whole.clone()), whole);
        assert_eq!(part.or(whole.clone()), Title { name: Some("D".into()), ..whole });
    }

    #[test]
    fn what_is_no_line_of_text_is_named() {
        for (text, word) in [
            (r#"{"name": 1}"#, "its name"),
            (r#"{"name": " "}"#, "its name"),
            (r#"{"about": "a\nb"}"#, "its about"),
            (r#"{"tags": "soft"}"#, "its tags"),
            (r#"{"tags": ["soft", ""]}"#, "its tags"),
            (r#"{"tags": [null]}"#, "its tags"),
        ] {
            let (title, faults) = take(text);
            assert_eq!(title, Title::default());
            assert!(faults.len() == 1 && faults[0].contains(word), "{faults:?}");
        }
    }
}
