//! Reasons why a frame was not finished.

use isophote::Error;
use isophote::engine::Error as EngineError;
use isophote_abi::openfx::OfxStatus;

/// Reason why a frame was not finished.
pub enum Stop {
    /// The user no longer wants it.
    Aborted,
    Status(OfxStatus),
    Error(Error),
    /// The source was passed on as it is, for this reason.
    PassedOn(String),
}

impl From<OfxStatus> for Stop {
    fn from(status: OfxStatus) -> Self {
        Self::Status(status)
    }
}

impl From<Error> for Stop {
    fn from(error: Error) -> Self {
        match error {
            Error::Engine(EngineError::Cancelled) => Self::Aborted,
            other => Self::Error(other),
        }
    }
}
