//! Problems, as a sentence each.

use ash::vk;
use std::path::PathBuf;

/// Reason why the costs are not known, or not what the table says.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// No Vulkan.
    #[error("Vulkan's loader cannot be loaded ({0}): install libvulkan1")]
    Loader(String),
    /// A call of Vulkan that failed.
    #[error("the driver does not give {what}: {result}")]
    Vulkan {
        /// Thing that was asked for.
        what: &'static str,
        /// Vulkan's own word.
        result: vk::Result,
    },
    /// Not one device.
    #[error(
        "Vulkan has {0} devices where RADV's is wanted alone: run this by `cargo xtask gpu-cost`, which chooses it"
    )]
    Devices(usize),
    /// A device of another driver.
    #[error("'{0}' is not RADV: run this by `cargo xtask gpu-cost`, which chooses it")]
    Device(String),
    /// A driver built without a disassembler.
    #[error("the driver does not tell its machine code: it was built without a disassembler")]
    Assembly,
    /// A figure that the driver does not tell.
    #[error("the driver does not tell '{0}'")]
    Statistic(&'static str),
    /// A shader that is not translated.
    #[error("the shader {name}: {reason}")]
    Shader {
        /// Its stem.
        name: String,
        /// The reason.
        reason: String,
    },
    /// A file that cannot be read or written.
    #[error("cannot read or write {}: {source}", path.display())]
    File {
        /// Path of the file.
        path: PathBuf,
        /// The reason.
        source: std::io::Error,
    },
    /// A kernel that is none.
    #[error("no kernel is named '{0}'")]
    Unknown(String),
    /// A file without a table.
    #[error("xtask/gpu-cost/COSTS.md has lost the markers of its table")]
    Markers,
    /// A line of the table that is none.
    #[error(
        "line {0} of the table in xtask/gpu-cost/COSTS.md is not as it was written: run `cargo xtask gpu-cost`"
    )]
    Table(usize),
    /// Kernels that cost more than the table says.
    #[error("shaders cost more than their table says. If they must, `cargo xtask gpu-cost` writes it anew:\n{}", .0.join("\n"))]
    Dearer(Vec<String>),
}

/// Result of what can fail here.
pub type Result<T> = std::result::Result<T, Error>;

impl Error {
    /// Makes an error of what Vulkan answers to a wish.
    pub fn vulkan(what: &'static str) -> impl Fn(vk::Result) -> Self {
        move |result| Self::Vulkan { what, result }
    }
}
