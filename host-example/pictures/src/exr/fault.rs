//! Reason why an EXR file is refused.

use std::path::Path;

use isophote_files::error::Error;

/// A problem of the file, or of what was chosen in it.
#[derive(Debug)]
pub enum Fault {
    /// The file cannot be read or written.
    File(isophote_exr_edit::Error),
    /// It lacks what was chosen.
    Choice {
        /// The fact that is refused.
        problem: String,
        /// Advice to put it right.
        fix: String,
    },
}

impl From<isophote_exr_edit::Error> for Fault {
    fn from(error: isophote_exr_edit::Error) -> Self {
        Self::File(error)
    }
}

impl Fault {
    /// The error of a file.
    pub fn of(self, path: &Path) -> Error {
        use isophote_exr_edit::Error as File;
        match self {
            Self::File(File::Damaged(problem)) => Error::malformed(path, "EXR", problem),
            Self::File(File::Unsupported { problem, remedy }) => Error::file(path, problem, remedy),
            Self::File(other) => Error::file(path, other, "use a smaller picture"),
            Self::Choice { problem, fix } => Error::file(path, problem, fix),
        }
    }
}
