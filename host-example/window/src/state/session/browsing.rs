//! Looks that are looked for: the browser, the comparison, and their files.

use std::path::Path;
use std::sync::Arc;

use super::Session;
use crate::state::browser::MOST_COMPARED;
use crate::state::browser::entry::Content;
use crate::state::browser::listing::Listing;
use crate::state::browser::title_edit::{self, TitleEdit, Words};
use crate::state::comparison::Comparison;
use crate::state::document::frame::Frame;
use crate::state::look::EditedLook;
use crate::state::notes::Subject;
use crate::state::preview::picture::Picture;
use crate::state::saving::Saving;
use crate::state::viewport::Compare;
use isophote_files::error::Error;

impl Session {
    /// True where something else is shown instead of the picture.
    pub fn is_covered(&self) -> bool {
        self.browser.is_open || self.browser.comparison.is_some()
    }

    /// Opens the browser, or closes it.
    pub fn toggle_browser(&mut self) {
        if self.browser.is_open {
            self.browser.is_open = false;
        } else if self.open.has_picture() {
            self.end_comparison();
            (self.browser.is_open, self.browser.is_outdated, self.browser.takes_focus) = (true, true, true);
            self.select_present();
        }
    }

    /// Takes over which looks there are.
    pub fn list(&mut self, listing: Listing) {
        self.notes.mended_but(Subject::List, &listing.problems);
        listing.problems.iter().for_each(|problem| self.notes.complain_of(Subject::List, problem));
        self.browser.take(&self.library, listing);
        if self.browser.selected.is_none() {
            self.select_present();
        }
    }

    fn select_present(&mut self) {
        let present = self.browser.find(&self.look().source).map(|entry| entry.id);
        self.browser.selected = present.or(self.browser.selected);
    }

    /// Shows the look of a card, and closes the browser if that is wanted.
    pub fn apply(&mut self, id: u64, closes: bool) {
        (self.browser.selected, self.browser.takes_focus) = (Some(id), true);
        match self.browser.entry(id).map(|entry| &entry.content) {
            Some(Content::Look(look)) => {
                let look = Arc::clone(look);
                if *look != *self.look() {
                    self.take(look);
                }
                self.browser.is_open &= !closes;
            }
            Some(Content::Broken(problem)) => self.notes.say(problem.clone()),
            None => {}
        }
    }

    /// Marks a look to be compared, or no more.
    pub fn mark(&mut self, id: u64) {
        if !self.browser.mark(id) {
            self.notes.say(format!("At most {MOST_COMPARED} looks are compared at once"));
        }
    }

    /// Shows the looks that are marked beside each other.
    pub fn compare_marked(&mut self) {
        let look = |id: &u64| self.browser.entry(*id).and_then(|entry| entry.look().cloned());
        let panes: Vec<Arc<EditedLook>> = self.browser.marked.iter().filter_map(look).collect();
        if panes.len() < 2 {
            return;
        }
        let before = std::mem::replace(&mut self.viewport.compare, Compare::Off);
        self.viewport.fit();
        self.browser.comparison = Some(Comparison { panes, before, from_browser: self.browser.is_open });
        self.browser.is_open = false;
    }

    /// Shows the picture, or the browser again if it was open before.
    pub fn end_comparison(&mut self) {
        if let Some(comparison) = self.browser.comparison.take() {
            self.viewport.compare = comparison.before;
            self.viewport.fit();
            self.browser.is_open = comparison.from_browser;
        }
    }

    /// Takes one of the looks that are compared.
    pub fn take_pane(&mut self, index: usize) {
        let look =
            self.browser.comparison.as_ref().and_then(|comparison| comparison.panes.get(index)).cloned();
        if let Some(look) = look {
            self.end_comparison();
            self.browser.is_open = false;
            self.take(look);
            self.select_present();
        }
    }

    /// Takes over the picture that previews are of, where it is another one; time that passes does not count.
    pub fn follow_picture(&mut self) {
        if !self.is_covered() || self.open.is_playing() && self.previews.picture().is_some() {
            return;
        }
        let exposure = self.viewport.exposure.exp2();
        let known = self.previews.picture();
        let picture = match self.open.playback() {
            Some(playback) => {
                let Some((frame, _)) = playback.frame(false) else { return };
                let (frame, things) = (Arc::clone(frame), playback.things());
                Picture { frame, things, size: playback.size(), exposure }
            }
            // That of a scene comes from the device.
            None => match known {
                Some(known) => Picture { exposure, ..(**known).clone() },
                None => return,
            },
        };
        let is_same = known.is_some_and(|known| {
            Arc::ptr_eq(&known.frame, &picture.frame) && known.exposure == picture.exposure
        });
        if !is_same {
            self.previews.set_picture(Arc::new(picture));
        }
    }

    /// The scene looks like this from now on.
    pub fn show_scene_frame(&mut self, frame: Frame) {
        let size = (frame.width, frame.height);
        let exposure = self.viewport.exposure.exp2();
        let frame = Arc::new(frame);
        self.previews.set_picture(Arc::new(Picture {
            frame,
            things: self.open.things(None),
            size,
            exposure,
        }));
    }

    /// Asks for the name and the tags of a look's file.
    pub fn ask_title(&mut self, id: u64) {
        let Some(entry) = self.browser.entry(id).filter(|entry| entry.has_title()) else { return };
        let words = Words::of(&entry.name, &entry.title);
        self.browser.title_edit = Some(TitleEdit { file: entry.source.clone(), words });
    }

    /// Writes the name and the tags that were typed.
    pub fn write_title(&mut self) {
        let Some(TitleEdit { file, words }) = self.browser.title_edit.take() else { return };
        let title = words.title(&file);
        self.edit_file(
            &file,
            || title_edit::write(&file, &title),
            |session| session.looks.retitle(&file, &title),
        );
    }

    /// Deletes the file of a look, which its owner has agreed to, until undo brings it back.
    pub fn delete(&mut self) {
        let Some(file) = self.browser.deleting.take() else { return };
        let remove = || {
            std::fs::remove_file(&file).map_err(|e| {
                Error::file(&file, format!("cannot be deleted: {e}"), "delete it in a file manager")
            })
        };
        self.edit_file(&file, remove, |session| {
            session.notes.say(format!("Deleted {}; undo brings it back", file.display()));
        });
    }

    /// Saves the present look: to its own file, or after its name has been asked.
    pub fn save_look(&mut self, elsewhere: bool) {
        let look = Arc::clone(self.looks.present());
        if look.is_plain() {
            return;
        }
        let own = look.files().into_iter().next().filter(|file| *file == look.source && !look.is_graph());
        let folder = own.as_deref().and_then(Path::parent).map(Path::to_owned);
        let folder = folder.unwrap_or_else(|| self.settings.place_for_looks());
        let mut saving = Saving::new(&look, &folder, true);
        match own.filter(|_| !elsewhere) {
            Some(own) => {
                saving.place(Some(&own));
                self.write_look(saving);
            }
            None => self.dialogs.saving = Some(saving),
        }
    }

    /// Asks for the name of a copy of a look.
    pub fn ask_copy(&mut self, id: u64) {
        let Some(look) = self.browser.entry(id).and_then(|entry| entry.look()) else { return };
        let mut saving = Saving::new(look, &self.settings.place_for_looks(), false);
        saving.words.name += " copy";
        saving.rename();
        self.dialogs.saving = Some(saving);
    }

    /// Saves what was asked for. A file that is there is replaced only when that has been asked.
    pub fn finish_saving(&mut self) {
        let Some(mut saving) = self.dialogs.saving.take() else { return };
        if saving.file().exists() && !saving.asks {
            saving.asks = true;
            self.dialogs.saving = Some(saving);
            return;
        }
        self.write_look(saving);
    }

    fn write_look(&mut self, mut saving: Saving) {
        match saving.write() {
            Ok(look) => {
                if let Some(folder) = look.source.parent() {
                    self.settings.look_folder = Some(folder.to_owned());
                    self.settings.add_look_folder(folder);
                }
                self.notes.say(format!("Saved {}", look.source.display()));
                self.browser.is_outdated = true;
                self.looks.keep(&look);
                if saving.is_present {
                    self.saved(look);
                }
            }
            Err(error) => {
                saving.problem = Some(error.to_string());
                self.dialogs.saving = Some(saving);
            }
        }
    }
}
