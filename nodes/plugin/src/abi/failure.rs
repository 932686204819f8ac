//! Failure of a call: every error of the library as a status with a message.

use isophote::engine;
use isophote_abi::*;
use std::any::Any;
use std::fmt::Write as _;

/// Failure of a call: the status and the line that a person reads.
#[derive(Debug)]
pub struct Failure {
    /// Status that the call returns.
    pub status: IsophoteStatus,
    /// Message that says what, where, and what to do about it.
    pub message: String,
}

/// Result of the inside of a call.
pub type Outcome<T> = Result<T, Failure>;

impl Failure {
    /// A failure of this status.
    pub fn new(status: IsophoteStatus, message: impl Into<String>) -> Self {
        Self { status, message: one_line(message.into()) }
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

/// A message on one line, as hosts print it on terminals: names in graph files may hold what moves a cursor or turns the
/// direction of text, which is shown as `\u001b`, as in JSON.
pub(super) fn one_line(message: String) -> String {
    let acts = |c: char| c.is_control() || matches!(c, '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    if !message.contains(acts) {
        return message;
    }
    let mut line = String::with_capacity(message.len());
    for c in message.chars() {
        match c {
            // Devices tell what is wrong with a shader on several lines.
            '\n' | '\r' | '\t' => line.push(' '),
            c if acts(c) => {
                let _ = write!(line, "\\u{:04x}", u32::from(c));
            }
            c => line.push(c),
        }
    }
    line
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_are_lines_that_terminals_show_as_they_are() {
        let shown = |message: &str| Failure::argument(message).message;
        assert_eq!(shown("no node 'größer 絵'"), "no node 'größer 絵'");
        assert_eq!(shown("no 'a\x1b]0;b\x07\u{9b}\u{202e}\0'"), r"no 'a\u001b]0;b\u0007\u009b\u202e\u0000'");
        assert_eq!(shown("a shader:\n\tno such function"), "a shader:  no such function");
    }
}
