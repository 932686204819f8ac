//! The name, description and tags of a preset's file: as they are typed, and as they are written.

use std::path::{Path, PathBuf};

use isophote_files::error::{Error, Result};
use isophote_files::files::{self, Existing};
use isophote_finishing::stylize::preset::{self, Preset, Title, is_line};
use isophote_finishing::stylize::source;

/// Words that are typed.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Words {
    /// The name.
    pub name: String,
    /// Description of the look.
    pub about: String,
    /// Tags with commas between them.
    pub tags: String,
}

/// A title that is being changed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TitleEdit {
    /// The file.
    pub file: PathBuf,
    /// Words that are typed.
    pub words: Words,
}

impl Words {
    /// Words of a title.
    pub fn of(name: &str, title: &Title) -> Self {
        let about = title.about.clone().unwrap_or_default();
        Self { name: name.to_owned(), about, tags: title.tags.join(", ") }
    }

    /// The title that they make of the preset of a file, whose name goes without saying.
    pub fn title(&self, file: &Path) -> Title {
        let line = |text: &str| Some(text.trim().to_owned()).filter(|text| is_line(text));
        let mut tags: Vec<String> = Vec::new();
        for tag in self.tags.split(',').filter_map(line) {
            if !tags.contains(&tag) {
                tags.push(tag);
            }
        }
        let stem = file.file_stem().unwrap_or_default().to_string_lossy();
        Title { name: line(&self.name).filter(|name| *name != stem), about: line(&self.about), tags }
    }
}

/// Writes a title into the file of a preset, of which all else stays.
///
/// # Errors
/// [`Error::Input`] for files that cannot be read or are no presets, [`Error::Failure`] when the disk refuses.
pub fn write(file: &Path, title: &Title) -> Result<()> {
    let text = source::read(file)?;
    if preset::is_graph(&text) {
        return Err(Error::file(file, "is a graph, which has no name or tags", "save it as a look first"));
    }
    let preset = Preset { title: title.clone(), ..preset::parse(file, &text)? };
    let text = preset::text(&preset)?;
    files::write_bytes(file, Existing::Replace, text.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_a_title_and_a_title_is_words() {
        let file = Path::new("/looks/dusk.json");
        let words =
            Words { name: " Dusk ".into(), about: "Soft lines.".into(), tags: "soft,, evening ,soft".into() };
        let title = words.title(file);
        assert_eq!((title.name.as_deref(), title.tags.join("|")), (Some("Dusk"), "soft|evening".into()));
        assert_eq!(Words::of("Dusk", &title).title(file), title);
        assert_eq!(Words { name: "dusk".into(), ..Words::default() }.title(file), Title::default());
    }

    #[test]
    fn only_the_title_of_a_file_changes() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("dusk.json");
        std::fs::write(
            &file,
            r#"{"style": "ink", "lengths": "pixels", "parameters": {"tone": {"1": 0.2, "9": 1}}}"#,
        )
        .unwrap();
        let before = preset::parse(&file, &std::fs::read_to_string(&file).unwrap()).unwrap();
        let title = Title { name: Some("Dusk".into()), about: None, tags: vec!["soft".into()] };
        write(&file, &title).unwrap();
        let after = preset::parse(&file, &std::fs::read_to_string(&file).unwrap()).unwrap();
        assert_eq!(after, Preset { title, ..before });
        for (text, words) in
            [("{", "is no JSON"), (r#"{"nodes": []}"#, "is a graph"), (r#"{"sytle": "ink"}"#, "sytle")]
        {
            std::fs::write(&file, text).unwrap();
            let error = write(&file, &Title::default()).unwrap_err().to_string();
            assert!(error.contains(words) && error.contains("dusk.json"), "{error}");
            assert_eq!(std::fs::read_to_string(&file).unwrap(), text, "it stays as it was");
        }
    }
}
