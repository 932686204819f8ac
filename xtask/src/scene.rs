//! `cargo xtask scene`: writes the demo scene, so that a machine without assets has something to render.

use crate::error::Result;
use crate::tools::{build, program, run as run_command};
use std::path::{Path, PathBuf};

/// The package that makes the scene.
pub const PACKAGE: &str = "isophote-demo-scene";

/// Place where the scene is written.
#[derive(clap::Args)]
pub struct Options {
    /// Folder to write to
    #[arg(long, value_name = "DIR", default_value = "target/scene")]
    out: PathBuf,
}

/// Builds what makes the scene and writes it.
///
/// # Errors
/// When it cannot be built or written.
pub fn run(options: &Options) -> Result<()> {
    build("debug", &[PACKAGE])?;
    write(&options.out).map(drop)
}

/// Writes the scene with the program as it is built, and returns the file of the whole scene.
///
/// # Errors
/// When it cannot be written.
pub fn write(folder: &Path) -> Result<PathBuf> {
    run_command(program(PACKAGE, "debug").arg(folder))?;
    Ok(folder.join("city.gltf"))
}
