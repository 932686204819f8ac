//! The window's end: asked for, put off while something would be lost, and certain.

/// State of the request to close the window.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Leaving {
    /// Nobody wants to close it.
    #[default]
    Stays,
    /// It is asked whether what is not saved may be lost.
    Asks,
    /// It closes when the export is done.
    Waits,
    /// A look is being saved, after which it closes if nothing else would be lost.
    Saves,
    /// It closes, as soon as an export has removed what is not whole.
    Closes,
}

impl Leaving {
    /// True where a question, or what follows from its answer, stands in front of everything else.
    pub fn is_shown(self) -> bool {
        matches!(self, Self::Asks | Self::Waits | Self::Closes)
    }
}
