//! Errors of looks and of the device that draws them.

use isophote::preset::Fault;

/// Error of a look, or of the device that draws it.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Error {
    /// Look that is none: the file, the problem and the way to mend it.
    #[error("{0}")]
    Look(#[from] Fault),
    /// File that cannot be read.
    #[error("{0}: cannot be read as text; name a preset of Isophote, such as res://dusk.json")]
    File(String),
    /// Look that cannot be planned for the viewport.
    #[error("{0}")]
    Plan(#[from] isophote::Error),
    /// Shader that cannot be compiled.
    #[error("the shader of kernel '{0}' cannot be compiled: {1}")]
    Shader(String, String),
    /// Refusal of Godot's device.
    #[error("Godot's rendering device refuses {0}")]
    Device(String),
}
