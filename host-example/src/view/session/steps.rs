//! Steps that are taken back and taken again: everything that makes the picture.

use std::sync::Arc;

use super::{Session, State};
use crate::view::look::Look;
use crate::view::scenery::Lighting;

impl Session {
    /// What undo would bring back.
    pub(super) fn state(&self) -> State {
        State {
            current: self.current,
            looks: self.looks.clone(),
            lighting: self.scenery.as_ref().map(|scenery| scenery.lighting.clone()),
        }
    }

    fn restore(&mut self, state: State) {
        let State { current, looks, lighting } = state;
        self.looks = looks;
        self.turn_to(current);
        if let (Some(scenery), Some(lighting)) = (&mut self.scenery, lighting) {
            scenery.lighting = lighting;
            scenery.relight();
        }
    }

    /// Changes the look; changes of the same thing are one step until [`Session::let_go`].
    pub fn edit(&mut self, what: &str, change: impl FnOnce(&mut Look)) {
        let before = self.state();
        let current = self.current;
        change(Arc::make_mut(&mut self.looks[current]));
        if self.look() != &*before.looks[current] {
            self.edits.record(what, &before);
        }
    }

    /// Changes the light.
    pub fn relight(&mut self, what: &str, change: impl FnOnce(&mut Lighting)) {
        let before = self.state();
        let Some(scenery) = &mut self.scenery else { return };
        change(&mut scenery.lighting);
        if Some(&scenery.lighting) != before.lighting.as_ref() {
            scenery.relight();
            self.edits.record(what, &before);
        }
    }

    /// Whatever was being changed is let go of.
    pub fn let_go(&mut self) {
        if self.edits.is_open() {
            let now = self.state();
            self.edits.close(&now);
        }
    }

    /// Takes the last step back.
    pub fn undo(&mut self) {
        let now = self.state();
        if let Some(before) = self.edits.undo(&now) {
            self.restore(before);
        }
    }

    /// Takes the last step that was taken back again.
    pub fn redo(&mut self) {
        let now = self.state();
        if let Some(after) = self.edits.redo(&now) {
            self.restore(after);
        }
    }

    /// Whether there are steps to take back, and to take again.
    pub fn can(&self) -> [bool; 2] {
        [self.edits.can_undo(), self.edits.can_redo()]
    }
}
