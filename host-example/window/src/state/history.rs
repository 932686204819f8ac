//! Undo and redo of everything that makes the picture: states of the past and of the future.

/// Most states that are kept; each is some kilobytes at most.
const MOST: usize = 400;

/// The states before and after the present one.
#[derive(Debug)]
pub struct History<S> {
    past: Vec<S>,
    future: Vec<S>,
    /// Name of what is being changed: as long as it is the same, its changes are one step.
    open: Option<String>,
}

impl<S> Default for History<S> {
    fn default() -> Self {
        Self { past: Vec::new(), future: Vec::new(), open: None }
    }
}

impl<S: Clone + PartialEq> History<S> {
    /// Something is about to change, named by `what`; this is how things are before. Changes of the same thing are one step
    /// until [`History::close`].
    pub fn record(&mut self, what: &str, before: &S) {
        self.future.clear();
        if self.open.as_deref() == Some(what) {
            return;
        }
        self.open = Some(what.to_owned());
        self.past.push(before.clone());
        if self.past.len() > MOST {
            self.past.remove(0);
        }
    }

    /// Whatever was being changed is let go of: the next change is a step of its own. A step that has changed nothing is
    /// forgotten.
    pub fn close(&mut self, now: &S) {
        if self.open.take().is_some() && self.past.last() == Some(now) {
            self.past.pop();
        }
    }

    /// Takes something out of all states, and forgets steps that changed nothing else.
    pub fn strip(&mut self, now: &S, strip: impl Fn(&mut S)) {
        self.open = None;
        for states in [&mut self.past, &mut self.future] {
            states.iter_mut().for_each(&strip);
            states.dedup();
            while states.last() == Some(now) {
                states.pop();
            }
        }
    }

    /// True while something is being changed.
    pub fn is_open(&self) -> bool {
        self.open.is_some()
    }

    /// The state before the last step, which replaces the present one.
    pub fn undo(&mut self, now: &S) -> Option<S> {
        self.close(now);
        let before = self.past.pop()?;
        self.future.push(now.clone());
        Some(before)
    }

    /// The state after the step that was taken back last, which replaces the present one.
    pub fn redo(&mut self, now: &S) -> Option<S> {
        let after = self.future.pop()?;
        self.open = None;
        self.past.push(now.clone());
        Some(after)
    }

    /// True where there is something to take back.
    pub fn can_undo(&self) -> bool {
        !self.past.is_empty()
    }

    /// True where something was taken back that can be done again.
    pub fn can_redo(&self) -> bool {
        !self.future.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_drag_is_one_step() {
        let (mut history, mut now) = (History::default(), 0);
        for value in 1..5 {
            history.record("width", &now);
            now = value;
        }
        history.close(&now);
        history.record("width", &now);
        now = 9;
        assert_eq!(history.undo(&now), Some(4));
        assert_eq!(history.undo(&4), Some(0));
        assert_eq!(history.undo(&0), None);
        assert_eq!((history.redo(&0), history.redo(&4), history.redo(&9)), (Some(4), Some(9), None));
    }

    #[test]
    fn steps_that_changed_only_what_is_taken_out_are_forgotten() {
        let mut history = History::default();
        for state in [(0, 0), (1, 0), (1, 5), (2, 5), (2, 6)] {
            history.record("a", &state);
            history.close(&(9, 9));
        }
        assert_eq!(history.undo(&(2, 7)), Some((2, 6)));
        history.strip(&(2, 0), |state| state.1 = 0);
        assert!(!history.can_redo());
        assert_eq!(history.undo(&(2, 0)), Some((1, 0)));
        assert_eq!(history.undo(&(1, 0)), Some((0, 0)));
        assert!(!history.can_undo());
    }

    #[test]
    fn what_changes_nothing_is_no_step_and_changes_forget_the_future() {
        let mut history = History::default();
        history.record("a", &1);
        history.close(&1);
        assert!(!history.can_undo());
        history.record("a", &1);
        assert_eq!(history.undo(&2), Some(1));
        assert!(history.can_redo());
        history.record("b", &1);
        assert!(!history.can_redo());
    }
}
