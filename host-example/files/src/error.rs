//! The host's one error type: every failure is a single line that says what is wrong, where, and how to
//! fix it, and knows the exit code that goes with it.

use std::fmt::Display;
use std::path::Path;

use isophote_loader::abi::{
    ISOPHOTE_ERROR_CANCELLED, ISOPHOTE_ERROR_DEVICE, ISOPHOTE_ERROR_INTERNAL, ISOPHOTE_ERROR_INVALID_HANDLE,
    ISOPHOTE_ERROR_NO_DEVICE, ISOPHOTE_ERROR_OUT_OF_MEMORY, IsophoteStatus,
};
use isophote_loader::{Fault, printable};

/// Reason why a command could not be carried out.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The input or the way the program was called is at fault (exit code 2).
    #[error("{place}: {problem}; {fix}")]
    Input {
        /// The file, option or value at fault.
        place: String,
        /// The problem with it.
        problem: String,
        /// Advice to put it right.
        fix: String,
    },
    /// The machine or a device could not do its part (exit code 1).
    #[error("{problem}; {fix}")]
    Failure {
        /// The problem.
        problem: String,
        /// Advice to put it right.
        fix: String,
    },
}

impl Error {
    /// An [`Error::Input`] about a file.
    pub fn file(path: &Path, problem: impl Display, fix: impl Display) -> Self {
        Self::input(path.display(), problem, fix)
    }

    /// An [`Error::Input`] about a picture that its decoder refuses.
    pub fn malformed(path: &Path, kind: &str, problem: impl Display) -> Self {
        Self::file(path, format!("is damaged and cannot be read as {kind}: {problem}"), "use an intact file")
    }

    /// An [`Error::Input`] about anything that has a name.
    pub fn input(place: impl Display, problem: impl Display, fix: impl Display) -> Self {
        Self::Input { place: one_line(place), problem: one_line(problem), fix: one_line(fix) }
    }

    /// An [`Error::Failure`].
    pub fn failure(problem: impl Display, fix: impl Display) -> Self {
        Self::Failure { problem: one_line(problem), fix: one_line(fix) }
    }

    /// The error that a fault of a preset is; it names its place, and how to put it right, or else these are it.
    pub fn of_fault(fault: Fault, place: impl Display, fix: impl Display) -> Self {
        let Fault { place: own, problem, fix: own_fix, node } = fault;
        let place = if own.is_empty() { place.to_string() } else { own };
        let fix = match (node.as_str(), own_fix) {
            ("", own) if own.is_empty() => fix.to_string(),
            ("", own) => own,
            (node, _) => format!("`isophote nodes {node}` lists its parameters"),
        };
        Self::input(place, problem, fix)
    }

    /// The same of a file that names the place at fault.
    #[must_use]
    pub fn within(self, path: &Path) -> Self {
        match self {
            Self::Input { place, problem, fix } => {
                Self::Input { place: one_line(format_args!("{}: {place}", path.display())), problem, fix }
            }
            Self::Failure { problem, fix } => {
                Self::Failure { problem: one_line(format_args!("{}: {problem}", path.display())), fix }
            }
        }
    }

    /// The process exit code: 2 for bad usage or input, 1 for everything else.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Input { .. } => 2,
            Self::Failure { .. } => 1,
        }
    }
}

/// Errors of the library, which know no place.
pub trait AtPlace {
    /// As the host's error. Devices, memory and mistakes of the library are failures; everything else is the fault of the
    /// input at `place`, which `fix` puts right.
    fn at(self, place: impl Display, fix: impl Display) -> Error;
}

impl AtPlace for isophote_loader::Error {
    fn at(self, place: impl Display, fix: impl Display) -> Error {
        let (status, message) = match self {
            Self::Call { status, message } => (status, message),
            Self::Fault { status, ref fault } if !is_failure(status) => {
                return Error::of_fault(fault.clone(), place, fix);
            }
            Self::Fault { status, fault } => (status, fault.problem),
            other => return other.into(),
        };
        match status {
            ISOPHOTE_ERROR_NO_DEVICE => Error::failure(
                message,
                "use --backend cpu, or install a graphics driver; a software one will do (on Debian: apt install \
                 mesa-vulkan-drivers libvulkan1)",
            ),
            ISOPHOTE_ERROR_DEVICE | ISOPHOTE_ERROR_OUT_OF_MEMORY => {
                Error::failure(message, "use a smaller picture or --backend cpu")
            }
            ISOPHOTE_ERROR_CANCELLED => Error::failure(message, "start again"),
            ISOPHOTE_ERROR_INVALID_HANDLE | ISOPHOTE_ERROR_INTERNAL => {
                Error::failure(message, "this is a mistake in the program; please report it")
            }
            _ => Error::input(place, message, fix),
        }
    }
}

/// Tells whether a status says that the machine or the library is at fault, and not what it was given.
const fn is_failure(status: IsophoteStatus) -> bool {
    matches!(
        status,
        ISOPHOTE_ERROR_NO_DEVICE
            | ISOPHOTE_ERROR_DEVICE
            | ISOPHOTE_ERROR_OUT_OF_MEMORY
            | ISOPHOTE_ERROR_CANCELLED
            | ISOPHOTE_ERROR_INVALID_HANDLE
            | ISOPHOTE_ERROR_INTERNAL
    )
}

impl From<isophote_loader::Error> for Error {
    fn from(error: isophote_loader::Error) -> Self {
        match error {
            isophote_loader::Error::Load { problem, fix } => Self::failure(problem, fix),
            error => Self::failure(error, "this is a mistake in the program; please report it"),
        }
    }
}

/// Messages of other libraries may span lines; ours never do. Names of files, and names in them, may hold anything.
fn one_line(text: impl Display) -> String {
    printable(&text.to_string().split_whitespace().collect::<Vec<_>>().join(" ")).into_owned()
}

/// Result of everything in the host.
pub type Result<T> = std::result::Result<T, Error>;
