//! Dialogs within the window: which of them are open.

use super::batch::Batch;
use super::leaving::Leaving;
use super::plan::Plan;
use super::saving::Saving;

/// Dialogs that are open, and the question whether the window may be closed.
#[derive(Debug, Default)]
pub struct Dialogs {
    /// Plan of the export, while that is asked.
    pub plan: Option<Plan>,
    /// Several pictures that the look is to be used on, while that is asked.
    pub batch: Option<Batch>,
    /// A look that is about to be saved.
    pub saving: Option<Saving>,
    /// True where the help is open.
    pub shows_help: bool,
    /// State of closing the window.
    pub leaving: Leaving,
}

impl Dialogs {
    /// Closes what is asked about an export: first the question whether files may be replaced, then all of it. Says whether
    /// there was anything.
    pub fn close_export(&mut self) -> bool {
        let asks =
            [self.plan.as_mut().map(|plan| &mut plan.asks), self.batch.as_mut().map(|batch| &mut batch.asks)];
        if asks.into_iter().flatten().any(|asks| asks.take().is_some()) {
            return true;
        }
        self.plan.take().is_some() || self.batch.take().is_some()
    }
}
