//! Manifests: a JSON object of names and their ids in hexadecimal digits, in a file's header or in a file beside it.

use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};

use isophote_cryptomatte::{Pattern, id};

/// Names in a message.
const MOST_SHOWN: usize = 12;
/// Names that are like one that is not there, in a message.
const MOST_NEAR: usize = 5;
/// Longest name that is compared with others, letters.
const LONGEST_COMPARED: usize = 200;
/// Most names that are compared with one.
const MOST_COMPARED: usize = 20_000;

/// Names of things with their ids, sorted.
#[derive(Clone, Debug, Default)]
pub struct Manifest(BTreeMap<String, u32>);

impl Manifest {
    /// Reads the JSON of a manifest.
    ///
    /// # Errors
    /// The problem with it.
    pub fn parse(json: &str) -> Result<Self, String> {
        let texts: BTreeMap<String, String> =
            serde_json::from_str(json).map_err(|e| format!("is no JSON of names with ids: {e}"))?;
        let mut ids = BTreeMap::new();
        for (name, text) in texts {
            let id = u32::from_str_radix(&text, 16);
            let id = id.map_err(|_| {
                format!("gives '{}' the id '{}'", name.escape_default(), text.escape_default())
            })?;
            ids.insert(name, id);
        }
        Ok(Self(ids))
    }

    /// The manifest of things of these names.
    pub fn of(names: &[String]) -> Self {
        Self(names.iter().map(|name| (name.clone(), id(name))).collect())
    }

    /// The id of a name.
    pub fn id(&self, name: &str) -> Option<u32> {
        self.0.get(name).copied()
    }

    /// All names that a pattern stands for, with their ids.
    pub fn names<'a>(&'a self, pattern: &'a Pattern) -> impl Iterator<Item = (&'a str, u32)> + 'a {
        self.0.iter().filter(|(name, _)| pattern.matches(name)).map(|(name, id)| (name.as_str(), *id))
    }

    /// Advice what to write instead of a name that is not there.
    pub fn advice(&self, wanted: &str) -> String {
        if self.0.is_empty() {
            return "it lists no names; write the whole name of a thing in the picture".into();
        }
        let small = wanted.to_lowercase();
        let mut near: Vec<(usize, &str)> = Vec::new();
        let comparable = self.0.keys().filter(|name| name.len() <= LONGEST_COMPARED);
        for name in comparable.take(MOST_COMPARED) {
            let lower = name.to_lowercase();
            let core = small.trim_matches(['*', '?']);
            let is_part = !core.is_empty() && lower.contains(core);
            let distance = if is_part { 0 } else { strsim::damerau_levenshtein(&small, &lower) };
            if distance <= small.chars().count() / 2 {
                near.push((distance, name));
            }
        }
        near.sort_unstable();
        if near.is_empty() {
            return format!("choose from {}", listed(self.0.keys().map(String::as_str), MOST_SHOWN));
        }
        format!("did you mean {}?", listed(near.into_iter().map(|(_, name)| name), MOST_NEAR))
    }
}

/// Some names for a message.
fn listed<'a>(names: impl Iterator<Item = &'a str> + Clone, most: usize) -> String {
    let shown: Vec<String> =
        names.clone().take(most).map(|name| name.chars().take(LONGEST_COMPARED).collect()).collect();
    match names.count().saturating_sub(shown.len()) {
        0 => shown.join(", "),
        more => format!("{} and {more} more", shown.join(", ")),
    }
}

/// The file of a manifest that a picture in `folder` names.
///
/// # Errors
/// The problem with the name, which may lead nowhere but into the folder and those in it, with slashes between them.
pub fn sidecar(folder: &Path, name: &str) -> Result<PathBuf, String> {
    let path = Path::new(name);
    let is_inside = path.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    if name.is_empty() || name.contains(['\\', '\0']) || !is_inside {
        return Err(format!(
            "is in a file '{}', which is not below the picture's folder",
            name.escape_default()
        ));
    }
    Ok(folder.join(path))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn manifests_are_read() {
        let manifest =
            Manifest::parse(r#"{"bunny":"13851a76","name_containing\/slash":"b0a04231","z":"7"}"#).unwrap();
        assert_eq!(manifest.id("bunny"), Some(0x1385_1a76));
        assert_eq!(manifest.id("name_containing/slash"), Some(0xb0a0_4231));
        assert_eq!(manifest.id("z"), Some(7));
        for bad in ["", "[]", r#"{"a": 1}"#, r#"{"a": "g"}"#, r#"{"a": "123456789"}"#, "{'a': '1'}"] {
            assert!(Manifest::parse(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn advice_names_what_is_near_or_there() {
        let all: String = (0..40).map(|n| format!(r#""thing{n:02}":"{n}","#)).collect();
        let manifest = Manifest::parse(&format!(r#"{{{all}"hero":"77"}}"#)).unwrap();
        assert_eq!(manifest.advice("heroo"), "did you mean hero?");
        assert_eq!(manifest.advice("Her*"), "did you mean hero?");
        let listed = manifest.advice("xyz");
        assert!(
            listed.starts_with("choose from hero, thing00") && listed.ends_with("and 29 more"),
            "{listed}"
        );
        assert!(Manifest::default().advice("a").contains("no names"));
    }

    #[test]
    fn files_beside_a_picture_stay_beside_it() {
        let at = |name: &str| sidecar(Path::new("shots"), name);
        assert_eq!(at("a.json"), Ok(PathBuf::from("shots/a.json")));
        assert_eq!(at("./m/a.json"), Ok(PathBuf::from("shots/./m/a.json")));
        for bad in ["", "/etc/passwd", "../a.json", "m/../../a.json", r"m\a.json", "a\0.json"] {
            assert!(at(bad).is_err(), "{bad}");
        }
    }
}
