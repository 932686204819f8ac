//! Closing the window without losing what was done in it, and closing what is open in it.

use super::Session;
use crate::state::leaving::Leaving;
use isophote_finishing::stylize::preset::Preset;

impl Session {
    /// Looks that are in no file as they are now, by their places: closing the window loses them.
    pub fn unsaved(&self) -> Vec<usize> {
        let is_lost = |index: &usize| {
            let look = &self.looks[*index];
            let kept = self.kept.get(&look.source).unwrap_or_else(|| look.opened());
            !look.is_plain() && !says_the_same(kept, &look.preset)
        };
        (0..self.looks.len()).filter(is_lost).collect()
    }

    /// Closes the window, or asks before if something would be lost.
    pub fn leave(&mut self) {
        if self.leaving != Leaving::Closes {
            let loses_nothing = self.unsaved().is_empty() && self.exported.is_none();
            self.leaving = if loses_nothing { Leaving::Closes } else { Leaving::Asks };
        }
    }

    /// Saves the first look that would be lost, and then goes on as [`Session::leave`]. A dialog for it may be open already.
    pub fn save_and_leave(&mut self) {
        let unsaved = self.unsaved();
        let present = unsaved.iter().find(|index| **index == self.current);
        let Some(index) = present.or(unsaved.first()) else { return self.leave() };
        self.leaving = Leaving::Saves;
        if !self.saving.as_ref().is_some_and(|saving| saving.is_present) {
            self.choose(*index);
            self.save_look(false);
        }
        self.follow_saving();
    }

    /// Goes on with closing the window after a look was saved; keeps it open where it was not.
    pub fn follow_saving(&mut self) {
        if self.leaving == Leaving::Saves && self.saving.is_none() {
            self.leaving = Leaving::Stays;
            if !self.unsaved().contains(&self.current) {
                self.leave();
            }
        }
    }

    /// The export has ended, well or not. What went wrong is to be seen, so the window stays open then.
    pub fn end_export(&mut self, is_done: bool) {
        self.exported = None;
        if self.leaving == Leaving::Waits {
            self.leaving = Leaving::Stays;
            if is_done {
                self.leave();
            }
        }
    }

    /// True where a dialog of the window is open, which keys belong to then.
    pub fn has_dialog(&self) -> bool {
        self.saving.is_some()
            || self.plan.is_some()
            || self.browser.title_edit.is_some()
            || self.browser.deleting.is_some()
    }

    /// Closes what is open in the window, one thing at a time from the front to the back; never the window itself.
    pub fn close_front(&mut self) {
        match self.leaving {
            Leaving::Asks | Leaving::Waits => return self.leaving = Leaving::Stays,
            Leaving::Closes => return,
            Leaving::Stays | Leaving::Saves => {}
        }
        if self.shows_help {
            self.shows_help = false;
        } else if self.browser.deleting.take().is_some()
            || self.browser.title_edit.take().is_some()
            || self.saving.take().is_some()
            || self.plan.take().is_some()
        {
            self.follow_saving();
        } else if self.comparison.is_some() {
            self.end_comparison();
        } else {
            self.browser.is_open = false;
        }
    }
}

/// True where two looks give the same pictures by the same words. Names and tags are written when they are typed.
fn says_the_same(a: &Preset, b: &Preset) -> bool {
    let sorted = |preset: &Preset| {
        let mut params = preset.params.clone();
        params.sort_by(|(a, _), (b, _)| a.cmp(b));
        params
    };
    a.style == b.style && a.lengths == b.lengths && sorted(a) == sorted(b)
}
