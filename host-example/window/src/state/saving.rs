//! A look that is about to be saved: its name, description and tags, and the place of its file.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::browser::title_edit::Words;
use super::look::EditedLook;
use isophote_files::error::{Error, Result};

/// Name and place that are typed before a look is saved.
#[derive(Clone, Debug, PartialEq)]
pub struct Saving {
    /// The look.
    pub look: Arc<EditedLook>,
    /// Name, description and tags.
    pub words: Words,
    /// The path of the file.
    pub path: String,
    /// True where it was asked if the file may be replaced.
    pub asks: bool,
    /// True where the look of the window is the one in the file afterwards.
    pub is_present: bool,
    /// Message about what went wrong.
    pub problem: Option<String>,
    /// True where the name of the file follows that of the look.
    follows: bool,
}

impl Saving {
    /// A look to be saved in a folder.
    pub fn new(look: &Arc<EditedLook>, folder: &Path, is_present: bool) -> Self {
        let words = Words::of(&look.name, &look.preset.title);
        let mut saving = Self {
            look: Arc::clone(look),
            words,
            path: folder.join("look.json").display().to_string(),
            asks: false,
            is_present,
            problem: None,
            follows: true,
        };
        saving.rename();
        saving
    }

    /// The file.
    pub fn file(&self) -> PathBuf {
        PathBuf::from(self.path.trim())
    }

    /// The name was changed, and with it that of the file where nobody has chosen another.
    pub fn rename(&mut self) {
        if self.follows {
            self.path =
                self.file().with_file_name(format!("{}.json", stem(&self.words.name))).display().to_string();
        }
        (self.asks, self.problem) = (false, None);
    }

    /// The file was chosen by itself.
    pub fn place(&mut self, file: Option<&Path>) {
        if let Some(file) = file {
            self.path = file.display().to_string();
        }
        (self.follows, self.asks, self.problem) = (false, false, None);
    }

    /// Writes the file, of which the look is what it was opened from then. The folder is made where there is none.
    ///
    /// # Errors
    /// As [`EditedLook::save`].
    pub fn write(&self) -> Result<EditedLook> {
        let file = std::path::absolute(self.file()).map_err(|e| {
            Error::input(&self.path, format!("is no path: {e}"), "name a file that ends in .json")
        })?;
        if let Some(folder) = file.parent() {
            std::fs::create_dir_all(folder)
                .map_err(|e| Error::file(folder, format!("cannot be made: {e}"), "name another folder"))?;
        }
        let mut look = (*self.look).clone();
        look.save(&file, self.words.title(&file))?;
        Ok(look)
    }
}

/// The name of a file without its ending, for a look of this name.
fn stem(name: &str) -> String {
    let letter = |c: char| if c.is_alphanumeric() { c } else { '-' };
    let stem: String = name.to_lowercase().chars().map(letter).collect();
    let words: Vec<&str> = stem.split('-').filter(|word| !word.is_empty()).collect();
    if words.is_empty() { "look".to_owned() } else { words.join("-") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_file_follows_the_name_until_it_is_chosen() {
        let mut saving = Saving::new(&Arc::new(EditedLook::plain()), Path::new("/looks"), true);
        // As paths: the system joins them with what it likes.
        let path = |saving: &Saving| PathBuf::from(&saving.path);
        assert_eq!(path(&saving), Path::new("/looks/original.json"));
        saving.words.name = "Dusk: Évening / No. 2".into();
        saving.rename();
        assert_eq!(path(&saving), Path::new("/looks/dusk-évening-no-2.json"));
        saving.place(Some(Path::new("/other/mine.json")));
        saving.words.name = "?".into();
        saving.rename();
        assert_eq!(saving.path, "/other/mine.json");
        assert_eq!(stem("../.."), "look");
    }
}
