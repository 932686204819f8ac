//! Faults of presets, in parts.

use crate::error::Error;
use serde::Serialize;
use std::fmt::{Display, Formatter};

/// Fault of a preset: where it is, what is wrong, and how to mend it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Fault {
    /// File and parameter at fault; empty where the caller knows them alone.
    pub place: String,
    /// Problem with it.
    pub problem: String,
    /// Way to put it right; empty where the problem says that.
    pub fix: String,
    /// Id of the node whose declaration says what is possible; empty for none.
    pub node: String,
    /// The kind of error that it is.
    #[serde(skip)]
    kind: Kind,
}

/// Kinds of errors, as hosts tell them apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Format,
    Value,
    Unknown,
    Connection,
}

impl Fault {
    fn new(kind: Kind, place: impl Display, problem: impl Display, fix: impl Display) -> Self {
        let [place, problem, fix] = [place.to_string(), problem.to_string(), fix.to_string()];
        Self { place, problem, fix, node: String::new(), kind }
    }

    /// Fault of a file that is not as the format says.
    pub(super) fn format(place: impl Display, problem: impl Display, fix: impl Display) -> Self {
        Self::new(Kind::Format, place, problem, fix)
    }

    /// Fault of a value that cannot be.
    pub(super) fn value(place: impl Display, problem: impl Display, fix: impl Display) -> Self {
        Self::new(Kind::Value, place, problem, fix)
    }

    /// Fault of a name that nothing bears.
    pub(super) fn unknown(place: impl Display, problem: impl Display, fix: impl Display) -> Self {
        Self::new(Kind::Unknown, place, problem, fix)
    }

    /// The fault that an error of a graph is.
    pub(super) fn of(error: Error, place: impl Display, fix: impl Display) -> Self {
        let kind = match error {
            Error::Unknown(_) => Kind::Unknown,
            Error::Value(_) => Kind::Value,
            Error::Connection(_) => Kind::Connection,
            Error::Format(_) | Error::Engine(_) => Kind::Format,
        };
        Self::new(kind, place, error, fix)
    }

    /// The fault with the node whose declaration says what is possible.
    pub(super) fn about_node(self, node: &str) -> Self {
        Self { node: node.to_owned(), ..self }
    }

    /// The fault at a place.
    #[must_use]
    pub fn at(self, place: impl Display) -> Self {
        Self { place: place.to_string(), ..self }
    }
}

impl Display for Fault {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        if !self.place.is_empty() {
            write!(f, "{}: ", self.place)?;
        }
        f.write_str(&self.problem)?;
        if self.fix.is_empty() { Ok(()) } else { write!(f, "; {}", self.fix) }
    }
}

impl std::error::Error for Fault {}

impl From<Fault> for Error {
    fn from(fault: Fault) -> Self {
        let text = fault.to_string();
        match fault.kind {
            Kind::Format => Self::Format(text),
            Kind::Value => Self::Value(text),
            Kind::Unknown => Self::Unknown(text),
            Kind::Connection => Self::Connection(text),
        }
    }
}
