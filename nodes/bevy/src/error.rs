//! Errors of looks and of their drawing.

use bevy::asset::ReadAssetBytesError;
use isophote::preset::Fault;

/// Error of a look, or of the device that draws it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Look that is none: the file, the problem and the way to mend it.
    #[error("{0}")]
    Look(#[from] Fault),
    /// File that cannot be read as text.
    #[error("{0}: is no text in UTF-8; write a preset of Isophote")]
    Text(String),
    /// File that cannot be read.
    #[error("the file of a look cannot be read: {0}")]
    Io(#[from] std::io::Error),
    /// Graph file beside a preset that cannot be read.
    #[error("the graph file of a look cannot be read: {0}")]
    Graph(#[from] ReadAssetBytesError),
    /// Look that cannot be planned for the camera.
    #[error("{0}")]
    Plan(#[from] isophote::Error),
    /// Device that refuses.
    #[error("{0}")]
    Device(#[from] isophote::engine::Error),
}
