//! Reasons why nothing was packed.

use std::path::{Path, PathBuf};

/// Problem with the archives.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A file cannot be read or written, or a program cannot be started.
    #[error("{}: {source}", path.display())]
    File {
        /// The file or program.
        path: PathBuf,
        /// Error of the system.
        source: std::io::Error,
    },
    /// A program failed.
    #[error("{command} failed: {said}")]
    Program {
        /// Command that was run.
        command: String,
        /// Message that it wrote about it.
        said: String,
    },
    /// Something that was read is not what it should be.
    #[error("{}: {problem}", path.display())]
    Malformed {
        /// Path of the file.
        path: PathBuf,
        /// The problem.
        problem: String,
    },
    /// A binary must not leave this machine as it is.
    #[error("{}: {problem}", path.display())]
    Unfit {
        /// The binary.
        path: PathBuf,
        /// The problem with it, and what to do.
        problem: String,
    },
    /// A dependency's licence is not one of those that were looked at.
    #[error(
        "{package} is licensed under `{licence}`, which the list of xtask/dist/src/licences.rs does not allow: read it, \
         then add it there or do without the package"
    )]
    Licence {
        /// Name and version.
        package: String,
        /// Licence that its manifest names.
        licence: String,
    },
}

impl Error {
    /// Makes an error of the system one about a file.
    pub fn at(path: &Path) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.to_owned();
        move |source| Self::File { path, source }
    }

    /// Something that was read is wrong.
    pub fn malformed(path: &Path, problem: impl ToString) -> Self {
        Self::Malformed { path: path.to_owned(), problem: problem.to_string() }
    }
}

/// The result of a step.
pub type Result<T> = std::result::Result<T, Error>;
