//! Listing of the looks that there are: those of the program, those in folders of the user, and plain styles.

use std::path::PathBuf;

use super::entry::{Content, Group};
use isophote_files::error::Error;
use isophote_finishing::stylize::preset::Title;
use isophote_loader::Library;

/// Looks that were found.
#[derive(Debug, Default)]
pub struct Listing {
    /// The looks, those of one group together.
    pub found: Vec<Found>,
    /// Files and folders that may change.
    pub watched: Vec<PathBuf>,
    /// Problems of folders.
    pub problems: Vec<Error>,
}

/// One look.
#[derive(Debug)]
pub struct Found {
    /// Group that it belongs to.
    pub group: Group,
    /// Name that it is opened by.
    pub source: PathBuf,
    /// Name of its style for people.
    pub style: String,
    /// The look, or why it cannot be used.
    pub content: Content,
}

impl Found {
    /// Name for people.
    pub fn name(&self) -> String {
        match &self.content {
            Content::Look(look) => look.name.clone(),
            Content::Broken(_) => self.source.file_name().unwrap_or_default().to_string_lossy().into_owned(),
        }
    }

    /// Description and tags that it gives of itself; a style or medium by itself says what its node does.
    pub fn title(&self, library: &Library) -> Title {
        let Content::Look(look) = &self.content else { return Title::default() };
        let about = match self.group {
            Group::Styles => library.find_node(&look.preset.style).ok().map(|node| node.hint.to_owned()),
            _ => None,
        };
        look.preset.title.clone().or(Title { name: None, about, tags: Vec::new() })
    }
}
