//! The browser of looks: what there is, which of it is shown, chosen and marked to be compared.

pub mod entry;
pub mod filter;
pub mod listing;
pub mod title_edit;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use self::entry::{Entry, Group};
use self::filter::Filter;
use self::listing::{Found, Listing};
use self::title_edit::TitleEdit;
use super::comparison::Comparison;
use isophote_loader::Library;

/// Most looks that are compared at once.
pub const MOST_COMPARED: usize = 6;

/// All looks and how they are shown.
#[derive(Debug, Default)]
pub struct Browser {
    /// True where it is shown instead of the picture.
    pub is_open: bool,
    /// Conditions of the looks that are shown.
    pub filter: Filter,
    /// Favourite looks, by the names that they are opened by.
    pub favourites: Vec<PathBuf>,
    /// The look whose details are shown.
    pub selected: Option<u64>,
    /// Looks that are to be compared, in the order in which they were marked.
    pub marked: Vec<u64>,
    /// Cards in a row, as they were last laid out.
    pub columns: usize,
    /// True where the selected card is to be scrolled to.
    pub scrolls: bool,
    /// True where the selected card is to have the focus.
    pub takes_focus: bool,
    /// True where the field that looks are searched by is to have the focus.
    pub searches: bool,
    /// True where the looks are to be read anew.
    pub is_outdated: bool,
    /// A name and tags that are being changed.
    pub title_edit: Option<TitleEdit>,
    /// The file that is to be deleted, if its owner agrees.
    pub deleting: Option<PathBuf>,
    /// Files and folders that may change.
    pub watched: Vec<PathBuf>,
    /// The looks that are seen beside each other, if any.
    pub comparison: Option<Comparison>,
    entries: Vec<Arc<Entry>>,
    numbered: u64,
}

/// A step from card to card.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// To the card before.
    Left,
    /// To the next card.
    Right,
    /// To the row above.
    Up,
    /// To the row below.
    Down,
}

impl Browser {
    /// A browser that is closed, with these favourites.
    pub fn new(favourites: Vec<PathBuf>) -> Self {
        Self { favourites, ..Self::default() }
    }

    /// Takes over what was found. Looks that are as they were keep their numbers.
    pub fn take(&mut self, library: &Library, listing: Listing) {
        let old = std::mem::take(&mut self.entries);
        for found in listing.found {
            let is_same = |entry: &&Arc<Entry>| {
                entry.source == found.source && entry.group == found.group && entry.content == found.content
            };
            let entry = match old.iter().find(is_same) {
                Some(entry) => Arc::clone(entry),
                None => Arc::new(self.numbered(library, found)),
            };
            self.entries.push(entry);
        }
        self.watched = listing.watched;
        let renamed = |id: u64| {
            let source = &old.iter().find(|entry| entry.id == id)?.source;
            Some(self.entries.iter().find(|entry| entry.source == *source)?.id)
        };
        let selected = self.selected.and_then(renamed);
        let marked = self.marked.iter().filter_map(|id| renamed(*id)).collect();
        (self.selected, self.marked) = (selected, marked);
    }

    fn numbered(&mut self, library: &Library, found: Found) -> Entry {
        self.numbered += 1;
        let (name, title) = (found.name(), found.title(library));
        let Found { group, source, style, content } = found;
        Entry { id: self.numbered, group, source, name, style, title, content }
    }

    /// All looks.
    pub fn entries(&self) -> &[Arc<Entry>] {
        &self.entries
    }

    /// The look of a number.
    pub fn entry(&self, id: u64) -> Option<&Arc<Entry>> {
        self.entries.iter().find(|entry| entry.id == id)
    }

    /// The look that is opened as something.
    pub fn find(&self, source: &Path) -> Option<&Arc<Entry>> {
        self.entries.iter().find(|entry| entry.source == source)
    }

    /// True for a favourite.
    pub fn is_favourite(&self, entry: &Entry) -> bool {
        self.favourites.contains(&entry.source)
    }

    /// The looks that are shown, by groups, of which favourites are the first.
    pub fn groups(&self) -> Vec<(&Group, Vec<&Arc<Entry>>)> {
        let shown = self.entries.iter().filter(|entry| self.filter.takes(entry));
        let (favourites, others): (Vec<_>, Vec<_>) = shown.partition(|entry| self.is_favourite(entry));
        let mut groups: Vec<(&Group, Vec<&Arc<Entry>>)> = Vec::new();
        if !favourites.is_empty() {
            groups.push((&Group::Favourites, favourites));
        }
        for entry in others.into_iter().filter(|_| !self.filter.favourites) {
            match groups.last_mut() {
                Some((group, list)) if **group == entry.group => list.push(entry),
                _ => groups.push((&entry.group, vec![entry])),
            }
        }
        groups
    }

    /// Marks a look to be compared, or no more; says whether that could be done.
    pub fn mark(&mut self, id: u64) -> bool {
        if let Some(at) = self.marked.iter().position(|marked| *marked == id) {
            self.marked.remove(at);
        } else if self.marked.len() < MOST_COMPARED
            && self.entry(id).is_some_and(|entry| entry.look().is_some())
        {
            self.marked.push(id);
        } else {
            return false;
        }
        true
    }

    /// The card that Tab goes to: the one that is selected, or the first where that is not shown.
    pub fn stop(&self) -> Option<u64> {
        let shown = || self.entries.iter().filter(|entry| self.filter.takes(entry)).map(|entry| entry.id);
        shown().find(|id| Some(*id) == self.selected).or_else(|| shown().next())
    }

    /// Selects the card beside the selected one, or the first.
    pub fn step(&mut self, step: Step) {
        let columns = self.columns.max(1);
        let groups = self.groups();
        let rows: Vec<Vec<u64>> = groups
            .iter()
            .flat_map(|(_, entries)| entries.chunks(columns).map(|row| row.iter().map(|e| e.id).collect()))
            .collect();
        let place = rows.iter().enumerate().find_map(|(y, row)| {
            let x = row.iter().position(|id| Some(*id) == self.selected)?;
            Some((x, y))
        });
        let at = |x: usize, y: usize| rows.get(y).and_then(|row| row.get(x.min(row.len().saturating_sub(1))));
        let next = match (place, step) {
            (None, _) => at(0, 0),
            (Some((x, y)), Step::Up) => y.checked_sub(1).and_then(|y| at(x, y)),
            (Some((x, y)), Step::Down) => at(x, y + 1),
            (Some((0, y)), Step::Left) => y.checked_sub(1).and_then(|y| at(usize::MAX, y)),
            (Some((x, y)), Step::Left) => at(x - 1, y),
            (Some((x, y)), Step::Right) if x + 1 < rows[y].len() => at(x + 1, y),
            (Some((_, y)), Step::Right) => at(0, y + 1),
        };
        if let Some(next) = next.copied() {
            (self.selected, self.scrolls, self.takes_focus) = (Some(next), true, true);
        }
    }

    /// Adds what was typed to what is searched for.
    pub fn search(&mut self, text: &str) {
        self.filter.text += text;
        self.searches = true;
    }
}
