//! What a call comes to: every error of the library as a status with a message.

use isophote::engine;
use isophote_abi::*;
use std::any::Any;

/// Why a call failed: the status and the line that a person reads.
#[derive(Debug)]
pub struct Failure {
    /// What the call returns.
    pub status: IsophoteStatus,
    /// What, where, and what to do about it.
    pub message: String,
}

/// What the inside of a call comes to.
pub type Outcome<T> = Result<T, Failure>;

impl Failure {
    /// A failure of this status.
    pub fn new(status: IsophoteStatus, message: impl Into<String>) -> Self {
        Self { status, message: message.into() }
    }

    /// An argument that is null, not text, or none of the listed numbers.
    pub fn argument(message: impl Into<String>) -> Self {
        Self::new(ISOPHOTE_ERROR_INVALID_ARGUMENT, message)
    }

    /// A size, stride or region that does not fit.
    pub fn geometry(message: impl Into<String>) -> Self {
        Self::new(ISOPHOTE_ERROR_GEOMETRY, message)
    }

    pub(super) fn panicked(payload: &(dyn Any + Send)) -> Self {
        let what = payload
            .downcast_ref::<&str>()
            .map(|s| (*s).to_owned())
            .or_else(|| payload.downcast_ref::<String>().cloned())
            .unwrap_or_else(|| "no message".into());
        Self::new(ISOPHOTE_ERROR_INTERNAL, format!("a mistake inside Isophote: {what}"))
    }
}

impl From<engine::Error> for Failure {
    fn from(error: engine::Error) -> Self {
        use engine::Error as E;
        let status = match &error {
            E::Geometry(_) => ISOPHOTE_ERROR_GEOMETRY,
            E::Input(_) => ISOPHOTE_ERROR_INPUT,
            E::Cancelled => ISOPHOTE_ERROR_CANCELLED,
            E::NoDevice(_) => ISOPHOTE_ERROR_NO_DEVICE,
            E::Device(_) => ISOPHOTE_ERROR_DEVICE,
            E::Memory(_) => ISOPHOTE_ERROR_OUT_OF_MEMORY,
            _ => ISOPHOTE_ERROR_INTERNAL,
        };
        Self::new(status, error.to_string())
    }
}

impl From<isophote::Error> for Failure {
    fn from(error: isophote::Error) -> Self {
        use isophote::Error as E;
        let status = match error {
            E::Engine(inner) => return inner.into(),
            E::Unknown(_) => ISOPHOTE_ERROR_UNKNOWN,
            E::Value(_) => ISOPHOTE_ERROR_OUT_OF_RANGE,
            E::Connection(_) => ISOPHOTE_ERROR_CONNECTION,
            E::Format(_) => ISOPHOTE_ERROR_MALFORMED,
            _ => ISOPHOTE_ERROR_INTERNAL,
        };
        Self::new(status, error.to_string())
    }
}
