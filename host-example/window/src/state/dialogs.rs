//! Dialogs within the window: which of them are open.

use super::leaving::Leaving;
use super::plan::Plan;
use super::saving::Saving;

/// Dialogs that are open, and the question whether the window may be closed.
#[derive(Debug, Default)]
pub struct Dialogs {
    /// Plan of the export, while that is asked.
    pub plan: Option<Plan>,
    /// A look that is about to be saved.
    pub saving: Option<Saving>,
    /// True where the help is open.
    pub shows_help: bool,
    /// State of closing the window.
    pub leaving: Leaving,
}
