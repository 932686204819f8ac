//! Steps that are taken back and taken again: everything that makes the picture.

use std::path::Path;

use super::{Session, State, TURNS};
use crate::state::scenery::Lighting;
use isophote_files::error::Result;

impl Session {
    /// State that undo would bring back.
    pub(super) fn state(&self) -> State {
        State {
            current: self.looks.current(),
            looks: self.looks.list().to_vec(),
            lighting: self.open.scenery().map(|scenery| scenery.lighting.clone()),
            keys: self.open.playback().and_then(|playback| playback.keys().cloned()),
            files: self.files.done(),
        }
    }

    fn restore(&mut self, state: State) {
        let State { current, looks, lighting, keys, files } = state;
        self.turn(current, |own| own.restore(looks, current));
        if let (Some(scenery), Some(lighting)) = (self.open.scenery_mut(), lighting) {
            scenery.lighting = lighting;
            scenery.relight();
        }
        self.lay(keys);
        let restored = self.files.go_to(files);
        self.browser.is_outdated |= !restored.is_empty();
        for file in restored {
            match file {
                Ok(file) if file.exists() => self.notes.say(format!("Restored {}", file.display())),
                Ok(file) => self.notes.say(format!("Deleted {}", file.display())),
                Err(problem) => self.notes.complain(&problem),
            }
        }
    }

    /// Changes a file of a look by `change`, as one step with what `then` changes in the window.
    pub(super) fn edit_file(
        &mut self,
        file: &Path,
        change: impl FnOnce() -> Result<()>,
        then: impl FnOnce(&mut Self),
    ) {
        self.let_go();
        let before = self.state();
        match self.files.change(file, change) {
            Ok(()) => {
                then(self);
                self.edits.record("file", &before);
                self.let_go();
            }
            Err(problem) => self.notes.complain(&problem),
        }
        self.browser.is_outdated = true;
    }

    /// Something else is open, which has its own light and maps: steps bring those of before back no more, and leave its own.
    pub(super) fn forget_open(&mut self) {
        let mut now = self.state();
        now.lighting = None;
        let keys = now.keys.clone();
        self.edits.strip(&now, |state| (state.lighting, state.keys) = (None, keys.clone()));
    }

    /// Changes the light.
    pub fn relight(&mut self, what: &str, change: impl FnOnce(&mut Lighting)) {
        let before = self.state();
        let Some(scenery) = self.open.scenery_mut() else { return };
        change(&mut scenery.lighting);
        if Some(&scenery.lighting) != before.lighting.as_ref() {
            scenery.relight();
            self.edits.record(what, &before);
        }
    }

    /// True where the wheel is changing a value: what it turns without a pause is one step.
    pub fn is_wheeled(&self) -> bool {
        self.wheeled.is_some_and(|at| at.elapsed() < TURNS)
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

    /// True where there are steps to take back, and to take again.
    pub fn can(&self) -> [bool; 2] {
        [self.edits.can_undo(), self.edits.can_redo()]
    }
}
