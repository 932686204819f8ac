//! The engine's one error enum.

use thiserror::Error;

/// Error while a plan is described, lowered or executed.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum Error {
    /// A size, stride or region that no image can have.
    #[error("{0}")]
    Geometry(String),
    /// The images handed to an executor do not match the plan's inputs.
    #[error("{0}")]
    Input(String),
    /// The caller asked to stop; nothing was written to the outputs.
    #[error("cancelled")]
    Cancelled,
    /// No graphics adapter is available, or it lacks what a plan needs.
    #[error("{0}")]
    NoDevice(String),
    /// The graphics device reported an error or was lost.
    #[error("{0}")]
    Device(String),
    /// More memory was asked for than exists.
    #[error("{0}")]
    Memory(String),
}

/// Shorthand for results of this crate.
pub type Result<T> = std::result::Result<T, Error>;
