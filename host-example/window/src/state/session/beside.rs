//! Steps to the file before and the next of the folder, and favourite looks.

use super::Session;
use crate::state::work::Request;

impl Session {
    /// Opens the file that is so many after the present one in its folder.
    pub fn open_beside(&mut self, by: i64) {
        if self.open.file().is_none() {
            return;
        }
        if let Some(file) = self.beside.step(by) {
            self.work.ask(Request::Open(file));
        } else if let Some((_, count)) = self.beside.place() {
            let end = if by > 0 { "last" } else { "first" };
            self.notes.say(format!("This is the {end} file of the folder, which has {count} to open"));
        }
    }

    /// Makes a look a favourite, or no more.
    pub fn star(&mut self, id: u64) {
        let Some(source) = self.browser.entry(id).map(|entry| entry.source.clone()) else { return };
        self.settings.toggle_favourite(&source);
        self.browser.favourites.clone_from(&self.settings.favourites);
        self.browser.scrolls = self.browser.selected == Some(id);
    }
}
