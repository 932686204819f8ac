//! Reasons why there is no gallery.

use std::path::PathBuf;

/// Problem with the gallery.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A file cannot be read or written, or the host cannot be started.
    #[error("{}: {source}", path.display())]
    File {
        /// The file or program.
        path: PathBuf,
        /// Error of the system.
        source: std::io::Error,
    },
    /// The host failed.
    #[error("the host failed: {0}")]
    Host(String),
    /// The host's catalogue is not JSON.
    #[error("the host's catalogue: {0}")]
    Catalogue(#[from] serde_json::Error),
    /// A node needs an input that no other node makes from a picture.
    #[error("nothing makes a {kind} for {node}")]
    NoMaker {
        /// The kind of the input.
        kind: String,
        /// The node.
        node: String,
    },
}

/// The result of a step.
pub type Result<T> = std::result::Result<T, Error>;
