//! Rules of looks for things, and names of files in looks, as they can be read from any folder.

use std::path::Path;

use serde_json::Value;

use isophote_files::error::{Error, Result};
use isophote_finishing::stylize::preset::{self, ObjectRule};

/// The name of a style in the preset at `source` as it can be read from anywhere: the paths of files are absolute.
///
/// # Errors
/// [`Error::Input`] for paths that no preset can hold.
pub fn whole_name(name: &str, source: &Path) -> Result<String> {
    if preset::is_written_out(name) || Path::new(name).extension().is_none() {
        return Ok(name.to_owned());
    }
    let file = preset::style_beside(name, source);
    let whole = std::path::absolute(&file).map_or_else(|_| file.clone(), Into::into).into_string();
    whole.map_err(|_| {
        Error::file(Path::new(&file), "has a path that is no UTF-8, which no preset can hold", "rename it")
    })
}

/// The rules of the preset at `source` in the same way: looks of things may be files.
///
/// # Errors
/// As [`whole_name`].
pub fn whole(rules: &[ObjectRule], source: &Path) -> Result<Vec<ObjectRule>> {
    let whole = |rule: &ObjectRule| {
        let mut rule = rule.clone();
        let look = rule.rule.get_mut("look");
        let name = match look {
            Some(Value::Object(written)) => written.get_mut("style"),
            name => name,
        };
        if let Some(Value::String(name)) = name {
            *name = whole_name(name, source)?;
        }
        Ok(rule)
    };
    rules.iter().map(whole).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn looks_of_things_are_found_from_anywhere() {
        let folder = std::env::temp_dir();
        let rule = |look: Value| {
            let rule = serde_json::json!({"match": "id:1", "look": look});
            let Value::Object(rule) = rule else { panic!("it is one") };
            ObjectRule { rule, things: "id:1".into(), control: [None; 4] }
        };
        let looks = ["hero.json".into(), serde_json::json!({"style": "graph.json"}), "ink".into()];
        let rules = whole(&looks.map(rule), &folder.join("rules.json")).unwrap();
        let file = |name: &str| folder.join(name).display().to_string();
        assert_eq!(rules[0].rule["look"], file("hero.json"));
        assert_eq!(rules[1].rule["look"]["style"], file("graph.json"));
        assert_eq!(rules[2].rule["look"], "ink");
    }
}
