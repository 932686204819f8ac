//! Presets and looks as files of this program: the library reads and writes their texts.

use std::ffi::OsString;
use std::path::Path;
use std::sync::OnceLock;

use super::suggest;
use isophote_files::error::{AtPlace, Error, Result};
use isophote_loader::Library;
pub use isophote_loader::preset::{LOOK, Lengths, Look, ObjectRule, Preset, StyleText, Title, Track};
use isophote_pictures::exr::MaskSource;

/// Way to put most presets right.
const FIX: &str = "correct the preset";

/// Reads the text of the file `path`.
///
/// # Errors
/// [`Error::Input`], the first fault: text that is no JSON or a graph, keys that are not known, naming the nearest, and values
/// that no parameter can have.
pub fn parse(path: &Path, text: &str) -> Result<Preset> {
    let (preset, faults) = examine(path, text)?;
    faults.into_iter().next().map_or(Ok(preset), Err)
}

/// As [`parse`], but goes on after what is wrong: what can be read, with all faults. The style is empty where none can be
/// read.
///
/// # Errors
/// [`Error::Input`] for what is no JSON object, of which nothing can be read, and for graphs.
pub fn examine(path: &Path, text: &str) -> Result<(Preset, Vec<Error>)> {
    let place = path.display().to_string();
    match Library::open()?.read_style(&place, text).map_err(|e| e.at(&place, FIX))? {
        StyleText::Graph => Err(Error::file(path, "is a graph and no preset", "name a preset")),
        StyleText::Preset(preset, faults) => {
            Ok((preset, faults.into_iter().map(|fault| Error::of_fault(fault, &place, FIX)).collect()))
        }
    }
}

/// Where the things are that the rules of the preset `place` match, by rule.
///
/// # Errors
/// [`Error::Input`] for words that name no things of a file.
pub fn things(place: &str, rules: &[ObjectRule]) -> impl Iterator<Item = Result<MaskSource>> {
    rules.iter().enumerate().map(move |(number, rule)| {
        let source = rule.things.parse().and_then(|source| match source {
            MaskSource::File(_) | MaskSource::Layer(_) => {
                Err("write cryptomatte:NAME, material:NAME or id:NUMBER".to_owned())
            }
            source => Ok(source),
        });
        let problem = || format!("matches '{}', which names no things", rule.things.escape_default());
        source.map_err(|fix| Error::input(format!("{place}: object {}", number + 1), problem(), fix))
    })
}

/// The text of a file that holds a preset.
///
/// # Errors
/// [`Error::Failure`] when the library fails.
pub fn text(preset: &Preset) -> Result<String> {
    Library::open()?.write_preset(preset).map_err(|e| e.at("the preset", FIX))
}

/// Tells whether the text of a JSON file is a graph and not a preset.
pub fn is_graph(text: &str) -> bool {
    let read = Library::open().and_then(|library| library.read_style("the file", text));
    matches!(read, Ok(StyleText::Graph))
}

/// Tells whether the name of a style is a graph itself, as JSON.
pub fn is_written_out(style: &str) -> bool {
    style.trim_start().starts_with('{')
}

/// The colour that a person wrote, gamma-encoded RGBA from 0 to 1, if it is one.
pub fn color(text: &str) -> Option<[f32; 4]> {
    static LIBRARY: OnceLock<Option<Library>> = OnceLock::new();
    LIBRARY.get_or_init(|| Library::open().ok()).as_ref()?.color(text).ok()
}

/// Tells whether a text can be the name, the description or a tag of a preset.
pub fn is_line(line: &str) -> bool {
    let title = Title { name: Some(line.to_owned()), ..Title::default() };
    let preset = Preset { title, style: "-".into(), lengths: None, params: Vec::new(), objects: Vec::new() };
    let read = text(&preset).and_then(|text| parse(Path::new("-"), &text));
    read.is_ok()
}

/// The `style` of a preset as it is to be opened by a program whose folder is another than that of the preset at `path`: graph
/// files lie beside the preset.
pub fn style_beside(style: &str, path: &Path) -> OsString {
    let is_file = style.to_ascii_lowercase().ends_with(".json");
    match path.parent() {
        Some(folder) if is_file => folder.join(style).into(),
        _ => style.into(),
    }
}

/// The style of a preset as people are told of it.
pub fn style_shown(preset: &Preset) -> &str {
    if is_written_out(&preset.style) { "a graph of its own" } else { &preset.style }
}

/// The id where a style or preset is named as a look, known or not.
pub fn id_of_look(style: &Path) -> Option<&str> {
    style.to_str()?.strip_prefix(LOOK)
}

/// Way to find a look.
pub const LIST_OF_LOOKS: &str = "`isophote preset list` lists them";

/// The error of a name that no style has, with the style that was meant where one is near. `fix` is how to find one otherwise.
pub fn unknown(library: &Library, refused: isophote_loader::Error, style: &Path, fix: &str) -> Error {
    let error = match refused {
        isophote_loader::Error::Fault { fault, .. } if !fault.fix.contains(LOOK) => {
            Error::file(style, fault.problem, fix)
        }
        refused => refused.at(style.display(), fix),
    };
    let name = style.to_string_lossy();
    match (suggest::style(library, &name), &error) {
        (Some(meant), Error::Input { .. }) if meant.style != name => {
            let kind = if id_of_look(style).is_some() { "look" } else { "style" };
            Error::file(style, format!("there is no such {kind}; did you mean {meant}?"), fix)
        }
        _ => error,
    }
}

/// All looks that ship, those of one style together.
///
/// # Errors
/// [`Error::Failure`] without a library.
pub fn looks() -> Result<Vec<Look>> {
    Ok(Library::open()?.looks()?)
}

/// The preset that a look is.
///
/// # Errors
/// [`Error::Input`] for what is no preset, which tests keep out of the library.
pub fn of_look(look: &Look) -> Result<Preset> {
    parse(Path::new(&look.name()), look.json)
}
