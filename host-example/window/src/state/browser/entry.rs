//! One look of the browser, with what is known of it.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::state::look::EditedLook;
use isophote_finishing::stylize::preset::Title;

/// Group that a look belongs to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Group {
    /// Favourites, which come first wherever they are from.
    Favourites,
    /// A folder of the user.
    Folder(PathBuf),
    /// It ships with the program.
    Shipped,
    /// It is a style by itself.
    Styles,
}

/// A look, or why it cannot be used.
#[derive(Clone, Debug, PartialEq)]
pub enum Content {
    /// The look.
    Look(Arc<EditedLook>),
    /// Message about what is wrong.
    Broken(String),
}

/// A look that can be chosen.
#[derive(Clone, Debug)]
pub struct Entry {
    /// Its number, which it keeps while it stays the same.
    pub id: u64,
    /// Group that it belongs to.
    pub group: Group,
    /// Name that it is opened by: the id of a style, a look that ships, or a file.
    pub source: PathBuf,
    /// Name for people.
    pub name: String,
    /// Name of its style for people.
    pub style: String,
    /// Description and tags that it gives of itself.
    pub title: Title,
    /// The look itself.
    pub content: Content,
}

impl Entry {
    /// The look, where it can be used.
    pub fn look(&self) -> Option<&Arc<EditedLook>> {
        match &self.content {
            Content::Look(look) => Some(look),
            Content::Broken(_) => None,
        }
    }

    /// Its file, if it is one of the user's.
    pub fn file(&self) -> Option<&Path> {
        matches!(self.group, Group::Folder(_)).then_some(&*self.source)
    }

    /// True where its file can hold a name and tags, which graphs cannot.
    pub fn has_title(&self) -> bool {
        self.file().is_some() && self.look().is_some_and(|look| !look.is_graph())
    }
}
