//! Several looks for the things of a picture, as a JSON file:
//!
//! ```json
//! [
//!   { "style": "watercolor" },
//!   { "preset": "hero.json", "params": { "line_amount": 2 }, "mask": "cryptomatte:hero" },
//!   { "style": "ink", "mask": "sky.####.png", "invert": true }
//! ]
//! ```
//!
//! Each look is made from the picture itself, and laid over the results of those before it where its mask is; one without a
//! mask covers everything. `style` and `preset` are the id of a node, a graph file, a preset or a look; `params` are those of a preset,
//! keyframes included, and come before what a preset says. `mask` is what `--mask` takes. Files are found from the folder of
//! the looks.

use std::path::{Path, PathBuf};

use serde_json::{Map, Value, json};

use super::masks::MaskChoice;
use crate::stylize::preset::{self, Preset};
use crate::stylize::source;
use crate::stylize::style::Style;
use isophote_files::error::{Error, Result};
use isophote_loader::Library;
use isophote_pictures::exr::MaskSource;

/// Keys of a look.
const KEYS: [&str; 5] = ["style", "preset", "params", "mask", "invert"];
/// Most looks of a file.
const MOST: usize = 64;

/// A look of a file.
#[derive(Clone, Debug)]
pub struct Entry {
    /// The file, and which of its looks this is.
    place: PathBuf,
    preset: Preset,
    /// Where it is.
    pub mask: Option<MaskChoice>,
}

/// Reads a file of looks, at least one.
///
/// # Errors
/// [`Error::Input`] for what is no list of looks, and for presets that cannot be read.
pub fn read(path: &Path) -> Result<Vec<Entry>> {
    let wrong = |problem: String| {
        Error::file(
            path,
            problem,
            "write a list such as [{\"style\": \"ink\", \"mask\": \"cryptomatte:hero\"}]",
        )
    };
    let json: Value =
        serde_json::from_str(&source::read(path)?).map_err(|e| wrong(format!("is no JSON: {e}")))?;
    let Value::Array(list) = json else { return Err(wrong("is no list of looks".into())) };
    if !(1..=MOST).contains(&list.len()) {
        return Err(wrong(format!("has {} looks, and there may be 1 to {MOST}", list.len())));
    }
    list.into_iter().enumerate().map(|(number, look)| Entry::new(path, number + 1, look)).collect()
}

impl Entry {
    fn new(path: &Path, number: usize, json: Value) -> Result<Self> {
        // In the same folder as the file, so that what it names is found.
        let place = path.with_file_name(format!(
            "{}: look {number}",
            path.file_name().unwrap_or_default().to_string_lossy()
        ));
        let wrong = |problem: &str, fix: &str| Error::file(&place, problem, fix);
        let Value::Object(mut look) = json else {
            return Err(wrong("is no object", "write {\"style\": \"ink\"}"));
        };
        if let Some(key) = look.keys().find(|key| !KEYS.contains(&key.as_str())) {
            let problem = format!("has an unknown key '{}'", key.escape_default());
            return Err(wrong(&problem, &format!("the keys are {}", KEYS.join(", "))));
        }
        let name = match (look.remove("style"), look.remove("preset")) {
            (Some(Value::String(name)), None) | (None, Some(Value::String(name))) => name,
            _ => return Err(wrong("names no style", "add either \"style\" or \"preset\", with a text")),
        };
        let preset = preset_of(&place, &name, look.remove("params"))?;
        let invert = match look.remove("invert") {
            None => false,
            Some(Value::Bool(invert)) if !invert || look.contains_key("mask") => invert,
            Some(_) => {
                return Err(wrong(
                    "says what to invert, but not how",
                    "write \"invert\": true beside a mask",
                ));
            }
        };
        let mask = match look.remove("mask") {
            None | Some(Value::Null) => None,
            Some(Value::String(text)) => {
                let source = text.parse().map_err(|fix: String| wrong("names no mask", &fix))?;
                Some(MaskChoice { source: beside(&place, source), invert })
            }
            Some(_) => return Err(wrong("names no mask", "write \"mask\" with a text, as for --mask")),
        };
        Ok(Self { place, preset, mask })
    }

    /// Its style.
    ///
    /// # Errors
    /// As [`Style::load`].
    pub fn style(&self, library: &Library) -> Result<Style> {
        Style::of_preset(library, &self.place, &self.preset)
    }
}

/// The style of this name with parameters, as a preset in the folder of the looks.
fn preset_of(place: &Path, name: &str, params: Option<Value>) -> Result<Preset> {
    let own = json!({ "style": name, "parameters": params.unwrap_or(Value::Object(Map::new())) });
    let own = preset::parse(place, &own.to_string())?;
    let is_look = preset::id_of_look(Path::new(name)).is_some();
    let file = if is_look { PathBuf::from(name) } else { place.with_file_name(name) };
    let is_file = Path::new(name).extension().is_some_and(|e| e.eq_ignore_ascii_case("json"));
    if !(is_look || is_file) {
        return Ok(own);
    }
    let text = source::read(&file)?;
    if preset::is_graph(&text) {
        return Ok(own);
    }
    let mut preset = preset::parse(&file, &text)?;
    // Graph files lie beside their preset, which may be in another folder than the looks.
    if preset.style.to_ascii_lowercase().ends_with(".json") {
        let folder = Path::new(name).parent().unwrap_or(Path::new(""));
        preset.style = folder.join(&preset.style).to_string_lossy().into_owned();
    }
    preset.params.retain(|(param, _)| own.params.iter().all(|(other, _)| other != param));
    preset.params.extend(own.params);
    Ok(preset)
}

/// The same mask, its file found from the folder of the looks.
fn beside(place: &Path, source: MaskSource) -> MaskSource {
    match source {
        MaskSource::File(path) => {
            MaskSource::File(place.parent().map_or_else(|| path.clone(), |folder| folder.join(&path)))
        }
        other => other,
    }
}
