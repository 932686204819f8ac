//! Content of an archive: files and links by their places.

use crate::error::{Error, Result};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// One file or link.
#[derive(Debug)]
pub enum Entry {
    /// A file of this machine.
    Copy(PathBuf),
    /// The same, which people run.
    Program(PathBuf),
    /// A text that was made.
    Text(String),
    /// A script that was made, which people run.
    Script(String),
    /// Another name for a file of the same folder.
    Link(String),
}

/// The entries of an archive by their paths, with slashes, in the order of their names.
#[derive(Debug, Default)]
pub struct Tree {
    /// See above.
    pub entries: BTreeMap<String, Entry>,
}

impl Tree {
    /// Adds an entry.
    pub fn add(&mut self, place: impl Into<String>, entry: Entry) {
        self.entries.insert(place.into(), entry);
    }

    /// Adds a text.
    pub fn text(&mut self, place: impl Into<String>, text: impl Into<String>) {
        self.add(place, Entry::Text(text.into()));
    }

    /// Adds a file of this machine.
    pub fn copy(&mut self, place: impl Into<String>, from: impl Into<PathBuf>) {
        self.add(place, Entry::Copy(from.into()));
    }

    /// Adds all files below a folder, or those whose names have the ending.
    ///
    /// # Errors
    /// [`Error::File`] for what cannot be read.
    pub fn folder(&mut self, place: &str, from: &Path, ending: &str) -> Result<()> {
        for entry in std::fs::read_dir(from).map_err(Error::at(from))? {
            let path = entry.map_err(Error::at(from))?.path();
            let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
            let place = format!("{place}/{name}");
            if path.is_dir() {
                self.folder(&place, &path, ending)?;
            } else if name.ends_with(ending) {
                self.copy(place, path);
            }
        }
        Ok(())
    }
}
