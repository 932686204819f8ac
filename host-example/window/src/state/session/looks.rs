//! The looks of the window: which is shown, and what becomes of it.

use std::path::Path;
use std::sync::Arc;

use super::Session;
use crate::state::chain::Chain;
use crate::state::look::{EditedLook, Parameter};
use crate::state::value::Value;
use isophote_files::error::Result;
use isophote_finishing::stylize::preset::Lengths;
use isophote_finishing::stylize::style::Setting;
use isophote_loader::Library;

impl Session {
    /// The look was saved.
    pub fn saved(&mut self, look: EditedLook) {
        let current = self.current;
        self.looks[current] = Arc::new(look);
        self.turn_to(current);
    }

    /// A file has what this look was opened as.
    pub(super) fn keep(&mut self, look: &EditedLook) {
        self.kept.insert(look.source.clone(), look.opened().clone());
    }

    pub(super) fn turn_to(&mut self, index: usize) {
        if index != self.current {
            self.record.begin();
            (self.watched, self.selected) = (None, None);
        }
        self.current = index;
        self.chain = self.look().chain(&self.library).unwrap_or_default();
        let is_there = |name: &str| self.chain.as_ref().is_some_and(|chain| chain.has(name));
        self.selected = self.selected.take().filter(|name| is_there(name));
        self.watched = self.watched.take().filter(|watched| is_there(watched.node()));
        match self.look().parameters(&self.library) {
            Ok(parameters) => self.parameters = parameters,
            Err(error) => self.notes.complain(&error),
        }
        self.idle.clear();
    }

    /// Changes the list of nodes.
    pub fn relink(&mut self, change: impl FnOnce(&mut Chain, &Library) -> Result<()>) {
        let Some(mut chain) = self.chain.clone() else { return };
        let changed = change(&mut chain, &self.library);
        match changed.and_then(|()| self.look().with_chain(&self.library, &chain)) {
            Ok(look) => {
                self.let_go();
                self.edit("nodes", |old| *old = look);
                self.let_go();
                self.turn_to(self.current);
            }
            Err(error) => self.notes.complain(&error),
        }
    }

    /// Gives a parameter a value.
    pub fn set(&mut self, parameter: &Parameter, value: &Value) {
        self.edit(&parameter.name, |look| look.set(parameter, value));
    }

    /// Gives a parameter its default.
    pub fn reset(&mut self, parameter: &Parameter) {
        self.let_go();
        self.edit(&parameter.name, |look| look.reset(parameter));
        self.let_go();
    }

    /// Gives all parameters their defaults.
    pub fn reset_all(&mut self) {
        self.let_go();
        self.edit("all", |look| look.preset.params.clear());
        self.let_go();
    }

    /// Shows the look of an index.
    pub fn choose(&mut self, index: usize) {
        if index >= self.looks.len() || index == self.current {
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
        self.choose((self.current + 1) % self.looks.len());
    }

    /// Shows a look that may be new here, as one step. A look that was opened as the same is replaced.
    pub fn take(&mut self, look: Arc<EditedLook>) {
        self.let_go();
        let before = self.state();
        let known = self.looks.iter().position(|known| known.source == look.source);
        let index = known.unwrap_or(self.looks.len());
        self.keep(&look);
        match known {
            Some(index) => self.looks[index] = look,
            None => self.looks.push(look),
        }
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
        match read {
            // What the window has written itself is known.
            Ok(look) if look.has_origin_of(self.look()) => self.keep(&look),
            Ok(look) => {
                self.keep(&look);
                let lost = self.look().is_changed();
                self.let_go();
                self.edit("file", |old| *old = look);
                self.let_go();
                self.turn_to(self.current);
                let rest = if lost { "; undo brings your changes back" } else { "" };
                self.notes.say(format!("{name} has changed and was read again{rest}"));
            }
            Err(error) => self.notes.complain(&error),
        }
    }

    /// Settings of the command line, for all looks that have such parameters, and what lengths mean.
    pub fn prepare(&mut self, settings: &[Setting], lengths: Option<Lengths>) {
        for look in self.looks.iter_mut().filter(|look| !look.is_plain()) {
            let look = Arc::make_mut(look);
            if lengths.is_some() {
                look.preset.lengths = lengths;
            }
            let parameters = look.parameters(&self.library).unwrap_or_default();
            settings.iter().for_each(|setting| look.take(&parameters, setting));
            self.kept.insert(look.source.clone(), look.preset.clone());
        }
    }

    /// Shows the look that was shown last, if it is still there.
    pub fn resume(&mut self, last: Option<&Path>) {
        let Some(last) = last else { return };
        let known = self.looks.iter().position(|look| look.source == last);
        match known {
            Some(index) => self.turn_to(index),
            None => {
                if let Ok(look) = EditedLook::open(&self.library, last) {
                    self.looks.push(Arc::new(look));
                    self.turn_to(self.looks.len() - 1);
                }
            }
        }
    }
}
