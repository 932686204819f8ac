//! Closing the window without losing what was done in it, and closing what is open in it.

use super::Session;
use crate::state::leaving::Leaving;
use crate::state::scenery::Scenery;

impl Session {
    /// Closes the window, or asks before if something would be lost.
    pub fn leave(&mut self) {
        if self.dialogs.leaving != Leaving::Closes {
            let loses_nothing = self.looks.unsaved().is_empty()
                && self.work.exported.is_none()
                && !self.has_changed_scene()
                && self.unsaved_maps().is_empty();
            self.dialogs.leaving = if loses_nothing { Leaving::Closes } else { Leaving::Asks };
        }
    }

    /// True where the camera or the light of a scene's file was changed, which only its command line keeps.
    pub fn has_changed_scene(&self) -> bool {
        self.open.file().is_some() && self.open.scenery().is_some_and(Scenery::is_changed)
    }

    /// Saves the first look that would be lost, and then goes on as [`Session::leave`]. A dialog for it may be open already.
    pub fn save_and_leave(&mut self) {
        let unsaved = self.looks.unsaved();
        let present = unsaved.iter().find(|index| **index == self.looks.current());
        let Some(index) = present.or(unsaved.first()) else { return self.leave() };
        self.dialogs.leaving = Leaving::Saves;
        if !self.dialogs.saving.as_ref().is_some_and(|saving| saving.is_present) {
            self.choose(*index);
            self.save_look(false);
        }
        self.follow_saving();
    }

    /// Goes on with closing the window after a look was saved; keeps it open where it was not.
    pub fn follow_saving(&mut self) {
        if self.dialogs.leaving == Leaving::Saves && self.dialogs.saving.is_none() {
            self.dialogs.leaving = Leaving::Stays;
            if !self.looks.unsaved().contains(&self.looks.current()) {
                self.leave();
            }
        }
    }

    /// The export has ended, well or not. What went wrong is to be seen, so the window stays open then.
    pub fn end_export(&mut self, is_done: bool) {
        (self.work.exported, self.work.running) = (None, None);
        if self.dialogs.leaving == Leaving::Waits {
            self.dialogs.leaving = Leaving::Stays;
            if is_done {
                self.leave();
            }
        }
    }

    /// True where files that are dropped on the window are taken: not behind a dialog.
    pub fn takes_files(&self) -> bool {
        !self.dialogs.leaving.is_shown() && !self.has_dialog()
    }

    /// True where a dialog of the window is open, which keys belong to then.
    pub fn has_dialog(&self) -> bool {
        self.dialogs.shows_help
            || self.dialogs.saving.is_some()
            || self.dialogs.plan.is_some()
            || self.dialogs.batch.is_some()
            || self.browser.title_edit.is_some()
            || self.browser.deleting.is_some()
    }

    /// Closes what is open in the window, one thing at a time from the front to the back; never the window itself.
    pub fn close_front(&mut self) {
        match self.dialogs.leaving {
            Leaving::Asks | Leaving::Waits => return self.dialogs.leaving = Leaving::Stays,
            Leaving::Closes => return,
            Leaving::Stays | Leaving::Saves => {}
        }
        if self.dialogs.shows_help {
            self.dialogs.shows_help = false;
        } else if self.browser.deleting.take().is_some()
            || self.browser.title_edit.take().is_some()
            || self.dialogs.saving.take().is_some()
            || self.dialogs.close_export()
        {
            self.follow_saving();
        } else if self.browser.comparison.is_some() {
            self.end_comparison();
        } else if self.browser.is_open {
            self.browser.is_open = false;
        } else {
            self.painting.is_on = false;
        }
    }
}
