//! Progress of an export.

/// Progress of an export.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Progress {
    /// Frames that are done; a picture by itself counts by its share.
    pub done: f64,
    /// All frames, as far as is known; 0 at first.
    pub total: f64,
    /// State that it is in.
    pub state: State,
}

/// State of an export.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum State {
    /// It goes on.
    #[default]
    Running,
    /// The output is there.
    Done,
    /// What of it could not be done; the rest is there.
    Partly(Vec<String>),
    /// The reason why there is none, or not all of it.
    Failed(String),
    /// It was ended; frames of a sequence that were whole stay.
    Cancelled,
}
