//! The looks of the window: which is shown, and what becomes of it.

use std::path::Path;
use std::sync::Arc;

use super::Session;
use crate::state::chain::Chain;
use crate::state::look::{EditedLook, Parameter};
use crate::state::looks::Looks;
use crate::state::notes::Subject;
use crate::state::resetting::Goal;
use crate::state::viewport::Compare;
use isophote_files::error::Result;
use isophote_finishing::stylize::palette::Colours;
use isophote_finishing::stylize::value::Value;
use isophote_loader::Library;

impl Session {
    /// The look was saved.
    pub fn saved(&mut self, look: EditedLook) {
        self.looks.replace(look);
        self.turn_to(self.looks.current());
    }

    pub(super) fn turn_to(&mut self, index: usize) {
        self.turn(index, |looks| looks.turn_to(index));
    }

    /// Turns to the look of an index by what `turn` does.
    pub(super) fn turn(&mut self, index: usize, turn: impl FnOnce(&mut Looks) -> Result<()>) {
        if index != self.looks.current() {
            self.record.begin();
        }
        self.notes.mended(Subject::Look);
        if let Err(error) = turn(&mut self.looks) {
            self.notes.complain_of(Subject::Look, &error);
        }
        self.tell_of_rules();
    }

    /// Says why rules of the look are for nothing in what is open, where that is so for all of them.
    pub(super) fn tell_of_rules(&mut self) {
        let look = self.looks.present();
        if look.has_rules() && self.open.has_picture() && !self.open.has_things() {
            let said = format!(
                "{} has rules for things, of which {} says nothing: it has neither Cryptomattes nor numbers of objects",
                look.name,
                self.open.name()
            );
            self.notes.say(said);
        }
    }

    /// True where a look that is shown has rules for things of what is open.
    pub fn follows_rules(&self) -> bool {
        let compared = self.looks.compared.as_ref().filter(|_| self.viewport.compare != Compare::Off);
        let is_whole = self.looks.watched().is_none();
        let has_rules = is_whole && self.look().has_rules() || compared.is_some_and(EditedLook::has_rules);
        has_rules && self.open.has_things()
    }

    /// Changes the list of nodes.
    pub fn relink(&mut self, change: impl FnOnce(&mut Chain, &Library) -> Result<()>) {
        let Some(mut chain) = self.looks.chain().cloned() else { return };
        let changed = change(&mut chain, &self.library);
        match changed.and_then(|()| self.look().with_chain(&self.library, &chain)) {
            Ok(look) => {
                self.let_go();
                self.edit("nodes", |old| *old = look);
                self.let_go();
                self.turn_to(self.looks.current());
            }
            Err(error) => self.notes.complain_of(Subject::Look, &error),
        }
    }

    /// Changes the look; changes of the same thing are one step until [`Session::let_go`].
    pub fn edit(&mut self, what: &str, change: impl FnOnce(&mut EditedLook)) {
        let before = self.state();
        if self.looks.edit(change) {
            self.notes.mended(Subject::Look);
            self.edits.record(what, &before);
        }
    }

    /// Gives a parameter a value.
    pub fn set(&mut self, parameter: &Parameter, value: &Value) {
        self.edit(&parameter.name, |look| look.set(parameter, value));
    }

    /// Gives the look the colours of a palette, as one step.
    pub fn colour_by(&mut self, palette: &Colours) {
        let settings = match self.look().style(&self.library) {
            Ok(Some(style)) => style.palette_settings(palette),
            Ok(None) => return,
            Err(error) => Err(error),
        };
        match settings {
            Ok(settings) => {
                let parameters = Arc::clone(self.looks.parameters());
                self.let_go();
                self.edit("palette", |look| {
                    settings.iter().for_each(|setting| look.take(&parameters, setting));
                });
                self.let_go();
                for note in palette.notes() {
                    self.notes.say(format!("{} {note}", palette.name()));
                }
            }
            Err(error) => self.notes.complain_of(Subject::Look, &error),
        }
    }

    /// Takes a parameter back to what it is in the look as that was chosen, or to its default where it is that already.
    pub fn reset(&mut self, parameter: &Parameter) {
        let Some(goal) = self.look().way_back_of(parameter) else { return };
        self.let_go();
        self.edit(&parameter.name, |look| match goal {
            Goal::Look => look.take_back(parameter),
            Goal::Style => look.reset(parameter),
        });
        self.let_go();
    }

    /// Goes back to the look as it was chosen, or to the defaults of its style where nothing differs from that.
    pub fn reset_all(&mut self) {
        let Some(goal) = self.look().way_back(self.looks.parameters()) else { return };
        self.let_go();
        self.edit("all", |look| look.go_back(goal));
        self.let_go();
        // The list of nodes may be another.
        self.turn_to(self.looks.current());
    }

    /// Shows the look of an index.
    pub fn choose(&mut self, index: usize) {
        if index >= self.looks.list().len() || index == self.looks.current() {
            return;
        }
        self.let_go();
        let before = self.state();
        self.edits.record("look", &before);
        self.turn_to(index);
        self.let_go();
    }

    /// Shows the next look.
    pub fn choose_next(&mut self) {
        self.choose((self.looks.current() + 1) % self.looks.list().len());
    }

    /// Shows the look before.
    pub fn choose_before(&mut self) {
        let count = self.looks.list().len();
        self.choose((self.looks.current() + count - 1) % count);
    }

    /// Shows a look that may be new here, as one step. A look that was opened as the same is replaced.
    pub fn take(&mut self, look: Arc<EditedLook>) {
        self.let_go();
        let before = self.state();
        self.looks.keep(&look);
        let index = self.looks.put(look);
        self.edits.record("look", &before);
        self.turn_to(index);
        self.let_go();
    }

    /// The files of the look that is shown may say something else now: this is what can be read of them.
    pub fn reload(&mut self, source: &Path, read: Result<EditedLook>) {
        if self.look().source != source {
            return;
        }
        let name = source.file_name().unwrap_or_default().to_string_lossy();
        if read.is_ok() {
            self.notes.mended(Subject::Look);
        }
        match read {
            // What the window has written itself is known.
            Ok(look) if look.has_origin_of(self.look()) => self.looks.keep(&look),
            Ok(look) => {
                self.looks.keep(&look);
                let lost = self.look().is_changed();
                self.let_go();
                self.edit("file", |old| *old = look);
                self.let_go();
                self.turn_to(self.looks.current());
                let rest = if lost { "; undo brings your changes back" } else { "" };
                self.notes.say(format!("{name} has changed and was read again{rest}"));
            }
            Err(error) => self.notes.complain_of(Subject::Look, &error),
        }
    }

    /// Shows the look that was shown last, if it is still there.
    pub fn resume(&mut self, last: Option<&Path>) {
        let Some(last) = last else { return };
        match self.looks.find(last) {
            Some(index) => self.turn_to(index),
            None => {
                if let Ok(look) = EditedLook::open(&self.library, last) {
                    let index = self.looks.put(Arc::new(look));
                    self.turn_to(index);
                }
            }
        }
    }
}
