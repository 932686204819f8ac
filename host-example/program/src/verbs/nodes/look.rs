//! A look as `isophote nodes` shows it.

use serde_json::Value;

use isophote_files::error::Result;
use isophote_finishing::stylize::preset::{self, Look, Preset, Track};
use isophote_loader::Library;

/// The look of a name, with the prefix of looks or without; nothing where there is none.
///
/// # Errors
/// As [`Library::looks`].
pub fn find(library: &Library, name: &str) -> Result<Option<Look>> {
    let id = name.strip_prefix(preset::LOOK).unwrap_or(name);
    Ok(library.looks()?.into_iter().find(|look| look.id == id))
}

/// The look as JSON, with its name.
pub fn object(look: &Look) -> Value {
    let mut object: Value = serde_json::from_str(look.json).unwrap_or_default();
    object["look"] = look.name().into();
    object
}

/// The look for people: its sentence, its style and the values that it gives it.
///
/// # Errors
/// As [`preset::of_look`].
pub fn describe(look: &Look) -> Result<String> {
    let name = look.name();
    let Preset { title, style, params, .. } = preset::of_look(look)?;
    let mut text = format!("{} ({name}, a look of {style})\n", title.name.as_deref().unwrap_or(look.id));
    text += &title.about.map_or_else(String::new, |about| format!("\n{about}\n"));
    if !title.tags.is_empty() {
        text += &format!("Tags: {}\n", title.tags.join(", "));
    }
    text += "\nValues\n";
    for (id, track) in &params {
        let value = match track {
            Track::Still(value) => value.clone(),
            Track::Keys { keys, .. } => {
                keys.iter().map(|(frame, value)| format!("{value} at {frame}")).collect::<Vec<_>>().join(", ")
            }
        };
        text += &format!("  {id} = {value}\n");
    }
    let used = format!("\n`isophote apply {name} photo.jpg` uses it; ");
    Ok(text + &used + &format!("`isophote nodes {style}` shows all parameters of its style.\n"))
}
