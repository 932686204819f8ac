//! Problems when the scene is made or written.

use std::path::PathBuf;

/// Reason why there is no scene.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// An encoder refused a texture.
    #[error("encoding {texture}: {source}")]
    Encode {
        /// The name of the texture's file.
        texture: &'static str,
        /// Error of the encoder.
        source: image::ImageError,
    },
    /// A file or the folder could not be written.
    #[error("writing {}: {source}", path.display())]
    Write {
        /// The file or the folder.
        path: PathBuf,
        /// Error of the system.
        source: std::io::Error,
    },
}

/// The result of making the scene.
pub type Result<T> = std::result::Result<T, Error>;
