//! What can go wrong when the scene is made or written.

use std::path::PathBuf;

/// Why there is no scene.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// An encoder refused a texture.
    #[error("encoding {texture}: {source}")]
    Encode {
        /// The name of the texture's file.
        texture: &'static str,
        /// What the encoder says.
        source: image::ImageError,
    },
    /// A file or the folder could not be written.
    #[error("writing {}: {source}", path.display())]
    Write {
        /// The file or the folder.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
}

/// The result of making the scene.
pub type Result<T> = std::result::Result<T, Error>;
