//! Reasons why there is no site.

use std::path::{Path, PathBuf};

/// Problem with the site.
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
    /// A picture cannot be read or written.
    #[error("{}: {source}", path.display())]
    Picture {
        /// The file.
        path: PathBuf,
        /// Error of the decoder.
        source: image::ImageError,
    },
    /// A program of the site's making failed.
    #[error("`{command}` failed: {said}")]
    Program {
        /// Command that was run.
        command: String,
        /// Text that it wrote.
        said: String,
    },
    /// A page is at fault.
    #[error("{page}: {problem}")]
    Page {
        /// Its source or place.
        page: String,
        /// The problem, and what would be right.
        problem: String,
    },
    /// Links that lead nowhere.
    #[error("{} links lead nowhere:\n{}", .0.len(), .0.join("\n"))]
    Links(Vec<String>),
    /// The library refuses a node of its own.
    #[error(transparent)]
    Library(#[from] isophote::Error),
}

impl Error {
    /// Makes an error of the system one about a file.
    pub fn at(path: &Path) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.to_owned();
        move |source| Self::File { path, source }
    }

    /// Makes an error of a decoder or encoder one about a file.
    pub fn picture(path: &Path) -> impl FnOnce(image::ImageError) -> Self {
        let path = path.to_owned();
        move |source| Self::Picture { path, source }
    }

    /// Something about a page.
    pub fn page(page: impl ToString, problem: impl ToString) -> Self {
        Self::Page { page: page.to_string(), problem: problem.to_string() }
    }
}

/// The result of a step.
pub type Result<T> = std::result::Result<T, Error>;
